# Flags that every source of ours is compiled with: target photon_splat_flags.

add_library(photon_splat_flags INTERFACE)

string(TOLOWER "${CMAKE_SYSTEM_PROCESSOR}" processor)
set(PHOTON_SPLAT_X86 OFF)
if(processor MATCHES "^(x86_64|amd64)$" AND NOT CMAKE_OSX_ARCHITECTURES MATCHES "arm64")
  set(PHOTON_SPLAT_X86 ON)
endif()

if(WIN32)
  # For every compiler's headers: M_PI is there, min and max are no macros.
  target_compile_definitions(photon_splat_flags INTERFACE NOMINMAX _USE_MATH_DEFINES WIN32_LEAN_AND_MEAN)
endif()

# SSE4.2 is what Blender itself asks of the machine. A toolchain file may have another name for it.
if(NOT DEFINED PHOTON_SPLAT_BASELINE)
  set(PHOTON_SPLAT_BASELINE -march=x86-64-v2)
endif()

if(MSVC)
  target_compile_options(photon_splat_flags INTERFACE /W4 /permissive- /Zc:__cplusplus /utf-8)
else()
  # No -ffast-math: pictures must be the same bit for bit, and NaN must stay recognisable.
  target_compile_options(photon_splat_flags INTERFACE -Wall -Wextra -fno-math-errno $<$<CONFIG:Release>:-O3>)
  if(PHOTON_SPLAT_X86)
    target_compile_options(photon_splat_flags INTERFACE ${PHOTON_SPLAT_BASELINE})
  endif()
endif()

if(PHOTON_SPLAT_WERROR)
  target_compile_options(photon_splat_flags INTERFACE $<IF:$<CXX_COMPILER_ID:MSVC>,/WX,-Werror>)
endif()

if(PHOTON_SPLAT_SANITIZE)
  set(sanitize -fsanitize=${PHOTON_SPLAT_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all -g)
  target_compile_options(photon_splat_flags INTERFACE ${sanitize})
  target_link_options(photon_splat_flags INTERFACE ${sanitize})
endif()
