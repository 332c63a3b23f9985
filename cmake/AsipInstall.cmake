# The library for other projects: find_package(asip), then link asip::client (or a layer below it).

include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(layers text protocol model session mqtt bus link client)
foreach(layer ${layers} options asio)
  set_target_properties(asip_${layer} PROPERTIES EXPORT_NAME ${layer})
endforeach()
list(TRANSFORM layers PREPEND asip_)
install(TARGETS ${layers} asip_options asip_asio EXPORT asip-targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/asip/" DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/asip COMPONENT library
  FILES_MATCHING PATTERN "*.hpp" PATTERN "program" EXCLUDE)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/asip)
install(EXPORT asip-targets NAMESPACE asip:: DESTINATION ${package_folder} COMPONENT library)
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/asip-config.cmake.in" "${PROJECT_BINARY_DIR}/asip-config.cmake"
  INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file("${PROJECT_BINARY_DIR}/asip-config-version.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/asip-config.cmake" "${PROJECT_BINARY_DIR}/asip-config-version.cmake"
  DESTINATION ${package_folder} COMPONENT library)
