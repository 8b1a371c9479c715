# Clang with the headers and libraries of other systems, as PyPI's ziglang packs it; the toolchain files beside this one set
# zig_target and include it. The zig is that of PHOTON_SPLAT_ZIG, else that of the Python in the environment variable
# PHOTON_SPLAT_PYTHON, else the first on the PATH.

set(PHOTON_SPLAT_ZIG "" CACHE FILEPATH "The zig that compiles for another system")
if(NOT PHOTON_SPLAT_ZIG AND DEFINED ENV{PHOTON_SPLAT_PYTHON})
  execute_process(
    COMMAND "$ENV{PHOTON_SPLAT_PYTHON}" -c
      "import os, ziglang; print(os.path.join(os.path.dirname(ziglang.__file__), 'zig').replace(os.sep, '/'))"
    OUTPUT_VARIABLE found OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE status ERROR_QUIET)
  if(status)
    message(FATAL_ERROR "ziglang is not installed for $ENV{PHOTON_SPLAT_PYTHON} (requirements-cross.txt).")
  endif()
  set(PHOTON_SPLAT_ZIG "${found}" CACHE FILEPATH "The zig that compiles for another system" FORCE)
elseif(NOT PHOTON_SPLAT_ZIG)
  find_program(PHOTON_SPLAT_ZIG zig REQUIRED)
endif()
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES PHOTON_SPLAT_ZIG)

set(CMAKE_C_COMPILER "${PHOTON_SPLAT_ZIG}" cc -target ${zig_target})
set(CMAKE_CXX_COMPILER "${PHOTON_SPLAT_ZIG}" c++ -target ${zig_target})

# CMake calls the archiver by a path alone.
set(zig_tools "${CMAKE_BINARY_DIR}/zig-tools")
foreach(tool ar ranlib)
  string(TOUPPER "${tool}" variable)
  if(CMAKE_HOST_WIN32)
    set(script "${zig_tools}/zig-${tool}.cmd")
    set(content "@\"${PHOTON_SPLAT_ZIG}\" ${tool} %*\r\n")
  else()
    set(script "${zig_tools}/zig-${tool}")
    set(content "#!/bin/sh\nexec '${PHOTON_SPLAT_ZIG}' ${tool} \"$@\"\n")
  endif()
  if(NOT EXISTS "${script}")
    file(WRITE "${script}" "${content}")
    file(CHMOD "${script}" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
  endif()
  set(CMAKE_${variable} "${script}" CACHE FILEPATH "")
endforeach()
set(PHOTON_SPLAT_DLLTOOL "${PHOTON_SPLAT_ZIG}" dlltool)

# Libraries and headers are those of the target, programs and Python packages those of this machine.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_CXX_SCAN_FOR_MODULES OFF)

# zig's names of what GCC and Clang call x86-64-v2, and of 512 bits in AVX-512.
set(PHOTON_SPLAT_BASELINE "-march=x86_64_v2")
set(PHOTON_SPLAT_AVX512_EXTRA -mevex512)
