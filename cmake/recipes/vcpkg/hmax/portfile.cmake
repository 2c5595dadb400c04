# An overlay port of this checkout: vcpkg install hmax --overlay-ports=cmake/recipes/vcpkg
get_filename_component(SOURCE_PATH "${CURRENT_PORT_DIR}/../../../.." ABSOLUTE)
set(VCPKG_BUILD_TYPE release)
vcpkg_cmake_configure(
    SOURCE_PATH "${SOURCE_PATH}"
    OPTIONS -DHMAX_BUILD_TESTS=OFF -DHMAX_BUILD_MICRO=OFF -DHMAX_BUILD_PYTHON=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/hmax)
vcpkg_copy_tools(TOOL_NAMES hmax AUTO_CLEAN)
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
