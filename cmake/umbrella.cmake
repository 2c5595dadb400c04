# hmax::hmax: the whole library behind one header, <hmax/hmax.hpp>, which stands in limits/hmax.hpp. The build tree looks
# like include/ of an installed hmax, by links to the folders.
add_library(hmax_umbrella INTERFACE)
target_link_libraries(hmax_umbrella INTERFACE hmax::studies)
set(umbrella_dir "${PROJECT_BINARY_DIR}/include")
file(MAKE_DIRECTORY "${umbrella_dir}/hmax")
foreach(entry core integrators problems results analysis catalogue limits bench advice studies plots)
  file(CREATE_LINK "${PROJECT_SOURCE_DIR}/${entry}" "${umbrella_dir}/hmax/${entry}" SYMBOLIC)
endforeach()
file(CREATE_LINK "${PROJECT_SOURCE_DIR}/limits/hmax.hpp" "${umbrella_dir}/hmax/hmax.hpp" SYMBOLIC)
target_include_directories(hmax_umbrella INTERFACE "$<BUILD_INTERFACE:${umbrella_dir}>")
set_target_properties(hmax_umbrella PROPERTIES EXPORT_NAME hmax)
add_library(hmax::hmax ALIAS hmax_umbrella)
