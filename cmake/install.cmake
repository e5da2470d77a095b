# What `cmake --install` gives: libraries, headers, programs and the package for find_package(lodestone).
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/lodestone)

function(lodestone_install_library target component)
  install(TARGETS ${target} EXPORT lodestone-${component} FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(EXPORT lodestone-${component} NAMESPACE lodestone:: DESTINATION ${package_dir})
  install(FILES ${PROJECT_SOURCE_DIR}/cmake/${component}_dependencies.cmake DESTINATION ${package_dir})
endfunction()

lodestone_install_library(lodestone core)
if(LODESTONE_FORMATS)
  lodestone_install_library(lodestone_formats formats)
endif()
if(LODESTONE_PROGRAMS)
  install(TARGETS lodestone_program lodestone-view)
endif()
if(TARGET lodestone-osgb)
  install(TARGETS lodestone-osgb)
endif()

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/lodestoneConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/lodestoneConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lodestoneConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/lodestoneConfig.cmake ${PROJECT_BINARY_DIR}/lodestoneConfigVersion.cmake
        DESTINATION ${package_dir})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
