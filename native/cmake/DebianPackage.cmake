# photon_splat_fetch_debian_package(NAME OUT): unpacks a package of the Debian archive under PHOTON_SPLAT_CACHE_DIR,
# without root (see debian_package.py). OUT is set to the folder that holds its files (usr/...), or to "" with the reason
# in OUT_error.

set(DEBIAN_SUITE trixie)

function(photon_splat_fetch_debian_package name out)
  set(folder "${PHOTON_SPLAT_CACHE_DIR}/debian-${DEBIAN_SUITE}")
  if(NOT EXISTS "${folder}/${name}")
    message(STATUS "Fetching ${name} from the Debian archive (once)")
  endif()
  execute_process(
    COMMAND "${Python_EXECUTABLE}" "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/debian_package.py" ${DEBIAN_SUITE} "${folder}" ${name}
    RESULT_VARIABLE status ERROR_VARIABLE reason ERROR_STRIP_TRAILING_WHITESPACE)
  if(status EQUAL 0)
    set(${out} "${folder}/${name}" PARENT_SCOPE)
  else()
    set(${out} "" PARENT_SCOPE)
    set(${out}_error "${reason}" PARENT_SCOPE)
  endif()
endfunction()
