# The splat, noise, bounce and Sobol' kernels, each file compiled for its own instruction set; part of photon_splat_core.
#
# A function with external linkage that such a file shares with the rest (an inline function of a header, a template of
# the standard library) may be kept by the linker in its AVX-512 form and then crash older machines. So these files
# define nothing but their entry points with external linkage; the test simd_symbols checks the object files.

function(add_simd_kernel file)
  set(path "${CMAKE_CURRENT_SOURCE_DIR}/src/simd/${file}")
  target_sources(photon_splat_core PRIVATE "${path}")
  set_source_files_properties("${path}" PROPERTIES COMPILE_OPTIONS "${ARGN}")
endfunction()

# The vector kernels are written with GCC's and Clang's vector extensions; other compilers have the plain one only.
# Noise and bounces are the same numbers on every machine: no fused products and sums.
set(exact "")
if(NOT MSVC)
  set(exact -ffp-contract=off)
endif()
add_simd_kernel(cpu_features.cpp)
add_simd_kernel(dispatch.cpp)
add_simd_kernel(splat_generic.cpp)
add_simd_kernel(noise_generic.cpp ${exact})
add_simd_kernel(bounce_generic.cpp ${exact})
add_simd_kernel(sobol_generic.cpp)
if(PHOTON_SPLAT_X86 AND NOT MSVC)
  add_simd_kernel(splat_sse42.cpp -msse4.2)
  add_simd_kernel(splat_avx2.cpp -mavx2 -mfma)
  add_simd_kernel(noise_sse42.cpp -msse4.2 ${exact})
  add_simd_kernel(bounce_sse42.cpp -msse4.2 ${exact})
  add_simd_kernel(noise_avx2.cpp -mavx2 ${exact})
  add_simd_kernel(bounce_avx2.cpp -mavx2 ${exact})
  add_simd_kernel(sobol_sse42.cpp -msse4.2)
  add_simd_kernel(sobol_avx2.cpp -mavx2)
  set(avx512 -mavx512f -mavx512vl -mavx512dq -mavx512bw -mfma -mprefer-vector-width=512
    ${PHOTON_SPLAT_AVX512_EXTRA}) # a toolchain file's
  add_simd_kernel(splat_avx512.cpp ${avx512})
  add_simd_kernel(noise_avx512.cpp ${avx512} ${exact})
  add_simd_kernel(bounce_avx512.cpp ${avx512} ${exact})
  add_simd_kernel(sobol_avx512.cpp ${avx512})
endif()
