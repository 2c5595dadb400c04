# Installs BUILD_DIR into WORK_DIR/prefix, then configures, builds and runs this folder against nothing but that prefix.
#   cmake -DBUILD_DIR=... -DWORK_DIR=... -DCXX=... -DGENERATOR=... [-DNM=nm -DLIBM=libm.so.6] -P run.cmake
# With NM its elementary functions must be those that hmax installed.
file(REMOVE_RECURSE "${WORK_DIR}")
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE failed OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(failed)
    string(JOIN " " command ${ARGN})
    message(FATAL_ERROR "${command}\nended with ${failed}:\n${output}")
  endif()
endfunction()
run("${CMAKE_COMMAND}" --install "${BUILD_DIR}" --prefix "${WORK_DIR}/prefix")
run("${CMAKE_COMMAND}" -S "${CMAKE_CURRENT_LIST_DIR}" -B "${WORK_DIR}/build" -G "${GENERATOR}" "-DCMAKE_CXX_COMPILER=${CXX}"
    "-DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix" -DCMAKE_BUILD_TYPE=Release)
run("${CMAKE_COMMAND}" --build "${WORK_DIR}/build")
execute_process(COMMAND "${WORK_DIR}/build/consumer" COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND "${WORK_DIR}/build/limit" COMMAND_ERROR_IS_FATAL ANY)
if(NM)
  run("${CMAKE_COMMAND}" "-DNM=${NM}" "-DLIBM=${LIBM}" "-DPROGRAM=${WORK_DIR}/build/consumer"
      -P "${CMAKE_CURRENT_LIST_DIR}/../own_elementary_functions.cmake")
endif()
