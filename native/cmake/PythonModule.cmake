# The Python module photon_splat_native: stable ABI from Python 3.12 on, one build per version before.

if(NOT TARGET Python::Module)
  message(FATAL_ERROR "Python's C headers are missing for ${Python_EXECUTABLE}; on Debian they are in python3-dev.")
endif()
if(NOT nanobind_ROOT)
  execute_process(
    COMMAND "${Python_EXECUTABLE}" -m nanobind --cmake_dir
    OUTPUT_VARIABLE nanobind_ROOT OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE status)
  if(status)
    message(FATAL_ERROR "nanobind is not installed for ${Python_EXECUTABLE}.")
  endif()
endif()
if(CMAKE_CROSSCOMPILING AND WIN32)
  # FindPython takes an import library for a static one, and adds what this machine's Python is linked to.
  foreach(target Python::Module Python::SABIModule)
    if(TARGET ${target})
      set_property(TARGET ${target} PROPERTY INTERFACE_LINK_LIBRARIES "")
    endif()
  endforeach()
endif()
# TLS descriptors may clobber vector registers with glibc before 2.40 (its bug 31372); nothing of ours is faster with them.
set(NB_HAS_MTLS_GNU2 OFF CACHE INTERNAL "")
find_package(nanobind CONFIG REQUIRED)

file(GLOB module_sources CONFIGURE_DEPENDS src/bindings/*.cpp bench/*.cpp)
set(lto "")
if(PHOTON_SPLAT_LTO)
  set(lto LTO)
endif()
# After an update a process has the modules of two versions: neither may take the other's types for its own.
string(REPLACE "." "_" versioned "photon_splat_native_${PROJECT_VERSION}")
nanobind_add_module(photon_splat_native STABLE_ABI NB_STATIC NOMINSIZE NB_SUPPRESS_WARNINGS NB_DOMAIN ${versioned} ${lto}
  ${module_sources})
set_source_files_properties(src/bindings/module.cpp PROPERTIES COMPILE_DEFINITIONS
  "PHOTON_SPLAT_VERSION=\"${PROJECT_VERSION}\"")
if(CMAKE_CROSSCOMPILING OR APPLE)
  # nanobind's headers name stderr, and leave it to others to include <cstdio>; libc++ does not.
  foreach(target nanobind-static nanobind-static-abi3 photon_splat_native)
    if(TARGET ${target})
      target_compile_options(${target} PRIVATE -include cstdio)
    endif()
  endforeach()
endif()
target_include_directories(photon_splat_native PRIVATE "${CMAKE_CURRENT_SOURCE_DIR}") # bench/
target_link_libraries(photon_splat_native PRIVATE photon_splat_core)

if(CMAKE_CROSSCOMPILING AND APPLE)
  set(CMAKE_CXX_CREATE_SHARED_MODULE "<CMAKE_AR> qc <TARGET> <OBJECTS>") # see toolchains/macos-arm64.cmake
endif()
if(CMAKE_CROSSCOMPILING AND WIN32)
  # This machine's Python knows another suffix.
  set_target_properties(photon_splat_native PROPERTIES SUFFIX .pyd)
endif()

# Blender has Embree, TBB and more in its global symbol scope: nothing of ours may be seen there, or be replaced by it.
if(UNIX AND NOT APPLE)
  set(version_script "${CMAKE_CURRENT_SOURCE_DIR}/cmake/exports.map")
  target_link_options(photon_splat_native PRIVATE "-Wl,--version-script=${version_script}")
  include(CheckLinkerFlag)
  check_linker_flag(CXX -Wl,--exclude-libs,ALL PHOTON_SPLAT_EXCLUDE_LIBS) # zig's linker lacks it
  if(PHOTON_SPLAT_EXCLUDE_LIBS)
    target_link_options(photon_splat_native PRIVATE -Wl,--exclude-libs,ALL)
  endif()
  set_target_properties(photon_splat_native PROPERTIES LINK_DEPENDS "${version_script}")
endif()
# Embree is the one that Blender has loaded: found by its soname, never by a path.
set_target_properties(photon_splat_native PROPERTIES SKIP_BUILD_RPATH ON INSTALL_RPATH "")

# Types and docstrings for type checkers and editors. Python imports the module for that, with the Embree that it is
# linked to; a package of stubs is where PEP 561 has checkers look for those of a single module.
set(stubs "${CMAKE_CURRENT_BINARY_DIR}/photon_splat_native-stubs/__init__.pyi")
set(environment "")
if(UNIX AND NOT APPLE)
  get_filename_component(embree_folder "${EMBREE_LIBRARY}" DIRECTORY)
  set(environment "LD_LIBRARY_PATH=${embree_folder}:$ENV{LD_LIBRARY_PATH}")
endif()
if(NOT PHOTON_SPLAT_SANITIZE AND NOT CMAKE_CROSSCOMPILING) # this machine's Python imports no module for another
  add_custom_command(OUTPUT "${stubs}" DEPENDS photon_splat_native VERBATIM
    COMMAND "${CMAKE_COMMAND}" -E make_directory "${CMAKE_CURRENT_BINARY_DIR}/photon_splat_native-stubs"
    COMMAND "${CMAKE_COMMAND}" -E env ${environment}
      "${Python_EXECUTABLE}" -m nanobind.stubgen -q -m photon_splat_native -i "$<TARGET_FILE_DIR:photon_splat_native>" -o "${stubs}")
  add_custom_target(photon_splat_native_stubs ALL DEPENDS "${stubs}")
  install(FILES "${stubs}" DESTINATION photon_splat_native-stubs)
endif()

# Windows lets no file be replaced that a process has loaded: an update brings a file of another name.
get_target_property(suffix photon_splat_native SUFFIX)
install(PROGRAMS "$<TARGET_FILE:photon_splat_native>" DESTINATION . RENAME "${versioned}${suffix}")
