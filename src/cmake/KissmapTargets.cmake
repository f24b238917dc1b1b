# What every target of this project shares: language rules, warnings, sanitizers, installation.
include(CMakePackageConfigHelpers)
find_package(Threads REQUIRED)

# Floating-point contraction is off everywhere: results must not depend on the compiler's mood.
add_compile_options(-ffp-contract=off)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND KISSMAP_MARCH)
  add_compile_options(-march=${KISSMAP_MARCH})
endif()
if(KISSMAP_SANITIZE)
  add_compile_options(-fsanitize=${KISSMAP_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${KISSMAP_SANITIZE})
endif()

function(kissmap_warnings target)
  # g++ 12 sees overlap in "literal" + std::string that is not there (GCC bug 105651).
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
    $<$<BOOL:${KISSMAP_WERROR}>:-Werror>)
endfunction()

# kissmap_library(NAME SOURCES ... PUBLIC ... PRIVATE ...): a layer, installed and exported.
function(kissmap_library name)
  cmake_parse_arguments(LIB "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${LIB_SOURCES})
  string(REPLACE "kissmap_" "" short ${name})
  add_library(kissmap::${short} ALIAS ${name})
  set_target_properties(${name} PROPERTIES EXPORT_NAME ${short})
  target_include_directories(${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${name} PUBLIC cxx_std_20)
  target_link_libraries(${name} PUBLIC ${LIB_PUBLIC} PRIVATE ${LIB_PRIVATE})
  kissmap_warnings(${name})
  install(TARGETS ${name} EXPORT kissmap-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
endfunction()

function(kissmap_install_package)
  set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/kissmap)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/kissmap DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(EXPORT kissmap-targets NAMESPACE kissmap:: DESTINATION ${package_dir})
  configure_package_config_file(${PROJECT_SOURCE_DIR}/src/cmake/kissmap-config.cmake.in
    ${PROJECT_BINARY_DIR}/kissmap-config.cmake INSTALL_DESTINATION ${package_dir})
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/kissmap-config-version.cmake
    COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/kissmap-config.cmake
    ${PROJECT_BINARY_DIR}/kissmap-config-version.cmake DESTINATION ${package_dir})
endfunction()
