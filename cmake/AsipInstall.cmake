# SPDX-License-Identifier: Apache-2.0
# The library for other projects: find_package(asip), then link asip::client.

include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(layers text protocol model property session mqtt bus catalogue caller link client)
foreach(layer ${layers} options asio)
  set_target_properties(asip_${layer} PROPERTIES EXPORT_NAME ${layer})
endforeach()
list(TRANSFORM layers PREPEND asip_)
install(TARGETS ${layers} asip_options asip_asio EXPORT asip-targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
# The headers of applications, and what these include. A test compiles each alone from the installed tree.
foreach(header
    client/awaitable client/blocking_board client/board client/error client/options client/stream
    client/transport expected protocol/pin time)
  get_filename_component(folder "asip/${header}" DIRECTORY)
  install(FILES "${PROJECT_SOURCE_DIR}/asip/${header}.hpp" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/${folder}" COMPONENT library)
endforeach()

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/asip)
install(EXPORT asip-targets NAMESPACE asip:: DESTINATION ${package_folder} COMPONENT library)
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/asip-config.cmake.in" "${PROJECT_BINARY_DIR}/asip-config.cmake"
  INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file("${PROJECT_BINARY_DIR}/asip-config-version.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/asip-config.cmake" "${PROJECT_BINARY_DIR}/asip-config-version.cmake"
  DESTINATION ${package_folder} COMPONENT library)
