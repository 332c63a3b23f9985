# SPDX-License-Identifier: Apache-2.0
# The library for other projects: find_package(asip), then link asip::client (or a layer below it).

include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(layers text protocol model session mqtt bus catalogue link client)
foreach(layer ${layers} options asio)
  set_target_properties(asip_${layer} PROPERTIES EXPORT_NAME ${layer})
endforeach()
list(TRANSFORM layers PREPEND asip_)
install(TARGETS ${layers} asip_options asip_asio EXPORT asip-targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
# What no public header includes stays inside.
set(inner_headers
  bus/members
  catalogue/board catalogue/catalogue_impl catalogue/description_members catalogue/due_wheel catalogue/model_units
  catalogue/name_table catalogue/query_plan
  client/board_core client/bus_transport client/direct_transport client/pending_calls
  link/baud link/stream_base
  model/argument_writer model/embedded
  mqtt/action mqtt/broker_list mqtt/client_core mqtt/connection mqtt/failure mqtt/host_lookup mqtt/outbox mqtt/properties mqtt/tls
  session/fences session/in_flight session/interview session/machine session/rate_change session/request
  session/request_queue session/search session/settings_memory session/waiting_requests session/wire)
list(TRANSFORM inner_headers REPLACE "(.+)" "PATTERN;asip/\\1.hpp;EXCLUDE")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/asip/" DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/asip COMPONENT library
  FILES_MATCHING PATTERN "*.hpp" PATTERN "program" EXCLUDE PATTERN "member" EXCLUDE PATTERN "policy" EXCLUDE ${inner_headers})

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/asip)
install(EXPORT asip-targets NAMESPACE asip:: DESTINATION ${package_folder} COMPONENT library)
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/asip-config.cmake.in" "${PROJECT_BINARY_DIR}/asip-config.cmake"
  INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file("${PROJECT_BINARY_DIR}/asip-config-version.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/asip-config.cmake" "${PROJECT_BINARY_DIR}/asip-config-version.cmake"
  DESTINATION ${package_folder} COMPONENT library)
