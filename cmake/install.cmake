# install: the program, one library and one header folder per folder of the house, and what find_package(hmax) reads.
# Headers include each other from include/hmax; users write <hmax/...>, from include.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/hmax")
set_target_properties(hmax_flags PROPERTIES EXPORT_NAME flags)
install(TARGETS hmax_flags hmax_core hmax_integrators hmax_problems hmax_results hmax_analysis hmax_catalogue hmax_limits hmax_bench hmax_advice hmax_studies hmax_plots hmax_umbrella hmax_plugin
        EXPORT hmax_targets
        ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development
        FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/hmax" COMPONENT development
        INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(FILES "${PROJECT_SOURCE_DIR}/limits/hmax.hpp" "${PROJECT_SOURCE_DIR}/catalogue/plugin/plugin.h" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/hmax"
        COMPONENT development)
foreach(optional elementary integrators_sundials integrators_odeint)
  if(TARGET hmax_${optional})
    install(TARGETS hmax_${optional} EXPORT hmax_targets
            ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development
            FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/hmax" COMPONENT development)
  endif()
endforeach()
get_target_property(modules hmax_addons MANUALLY_ADDED_DEPENDENCIES)
# Modules of engines are apart: who probes a scene of MuJoCo needs no PETSc.
set(module_components)
foreach(module IN LISTS modules)
  if(module MATCHES "petsc|mpi")
    set(component modules)
  elseif(module STREQUAL "hmax_cuda")  # no library of CMake
    install(FILES "${PROJECT_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR}/hmax/hmax_cuda.so" DESTINATION "${CMAKE_INSTALL_LIBDIR}/hmax" COMPONENT engines)
    list(APPEND module_components engines)
    continue()
  elseif(module)
    set(component engines)
  else()
    continue()
  endif()
  list(APPEND module_components ${component})
  install(TARGETS ${module} LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}/hmax" COMPONENT ${component})
endforeach()
list(REMOVE_DUPLICATES module_components)
install(TARGETS hmax RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT program)
install(EXPORT hmax_targets NAMESPACE hmax:: FILE hmaxTargets.cmake DESTINATION "${package_dir}" COMPONENT development)

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/hmaxConfig.cmake.in" "${PROJECT_BINARY_DIR}/hmaxConfig.cmake"
                              INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/hmaxConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/hmaxConfig.cmake" "${PROJECT_BINARY_DIR}/hmaxConfigVersion.cmake"
        DESTINATION "${package_dir}" COMPONENT development)
