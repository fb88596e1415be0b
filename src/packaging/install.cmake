# What is installed, by component: library (shared libraries), headers (all that a user's project needs), tool; and Debian
# packages of the three. cmake --install BUILD --component headers; cpack --config BUILD/CPackConfig.cmake.

set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/darboux)
set(libraries darboux)
if(DARBOUX_WITH_FIT)
  list(APPEND libraries darboux_fit)
endif()
if(DARBOUX_WITH_IO)
  list(APPEND libraries darboux_io)
endif()
# One export set per target, so that users of the core need neither Ceres nor assimp.
foreach(target IN LISTS libraries)
  install(TARGETS ${target} EXPORT ${target}Targets
    LIBRARY COMPONENT library NAMELINK_COMPONENT headers
    ARCHIVE COMPONENT headers
    FILE_SET HEADERS COMPONENT headers)
  install(EXPORT ${target}Targets NAMESPACE darboux:: DESTINATION ${config_dir} COMPONENT headers)
endforeach()
if(DARBOUX_WITH_TOOL)
  install(TARGETS darboux_tool RUNTIME COMPONENT tool)
  install(FILES docs/findings.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tool)
endif()
foreach(component library headers tool)
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR}-${component} COMPONENT ${component})
endforeach()

configure_package_config_file(src/packaging/darbouxConfig.cmake.in ${PROJECT_BINARY_DIR}/darbouxConfig.cmake
  INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/darbouxConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/darbouxConfig.cmake ${PROJECT_BINARY_DIR}/darbouxConfigVersion.cmake
  DESTINATION ${config_dir} COMPONENT headers)

# ---- pkg-config -----------------------------------------------------------------------------------------------
# darboux.pc, darboux-fit.pc, darboux-io.pc. Of static libraries, pkg-config --static names what they need.
function(darboux_pkg_config name description library requires requires_private libs_private)
  set(PC_NAME ${name})
  set(PC_DESCRIPTION ${description})
  set(PC_LIBRARY ${library})
  set(PC_REQUIRES "${requires}")
  set(PC_REQUIRES_PRIVATE "${requires_private}")
  set(PC_LIBS_PRIVATE "${libs_private}")
  configure_file(src/packaging/darboux.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT headers)
endfunction()
darboux_pkg_config(darboux "${PROJECT_DESCRIPTION}" darboux "eigen3" "tbb" "")
if(DARBOUX_WITH_FIT)
  darboux_pkg_config(darboux-fit "Surfaces from points and meshes" darboux_fit "darboux" "" "-lceres -lglog")
endif()
if(DARBOUX_WITH_IO)
  darboux_pkg_config(darboux-io "Meshes, points and surfaces from files" darboux_io "darboux"
    "assimp draco libpng muparser OpenEXR pugixml" "-lmeshoptimizer -llzf")
endif()

# ---- Debian packages --------------------------------------------------------------------------------------------
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME darboux)
set(CPACK_PACKAGE_VENDOR Darboux)
set(CPACK_PACKAGE_CONTACT "the Darboux maintainers <darboux@users.noreply.github.com>")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)
set(so_version ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libdarboux${so_version})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_HEADERS_PACKAGE_NAME libdarboux-dev)
set(CPACK_DEBIAN_HEADERS_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_HEADERS_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4), libtbb-dev (>= 2021)")
set(CPACK_DEBIAN_HEADERS_PACKAGE_SUGGESTS
  "libceres-dev, libassimp-dev, libdraco-dev, libmeshoptimizer-dev, libmuparser-dev, libopenexr-dev, libpng-dev, libpugixml-dev, liblzf-dev")
set(CPACK_DEBIAN_TOOL_PACKAGE_NAME darboux)
set(CPACK_DEBIAN_TOOL_PACKAGE_SECTION graphics)
set(CPACK_COMPONENTS_ALL headers)
if(BUILD_SHARED_LIBS)
  list(APPEND CPACK_COMPONENTS_ALL library)
  set(CPACK_COMPONENT_HEADERS_DEPENDS library)
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_GENERATE_SHLIBS ON)
endif()
if(DARBOUX_WITH_TOOL)
  list(APPEND CPACK_COMPONENTS_ALL tool)
  if(BUILD_SHARED_LIBS)
    set(CPACK_COMPONENT_TOOL_DEPENDS library)
  endif()
endif()
include(CPack)
