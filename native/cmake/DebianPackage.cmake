# photon_splat_fetch_debian_package(NAME OUT_DIR): unpacks a package of Debian's stable archive without root.
#
# The mirror is the one that this machine's apt uses already. apt works with a source list, package lists and a cache of
# its own under PHOTON_SPLAT_CACHE_DIR, so that the system stays as it is, and checks the Debian archive's signature.
# OUT_DIR is set to the folder that holds the package's files (usr/...), or to "" with the reason in OUT_DIR_error.

set(DEBIAN_SUITE trixie)
set(DEBIAN_KEYRING /usr/share/keyrings/debian-archive-keyring.gpg)

function(photon_splat_fetch_debian_package name out_dir)
  set(root "${PHOTON_SPLAT_CACHE_DIR}/debian-${DEBIAN_SUITE}")
  set(unpacked "${root}/${name}")
  file(MAKE_DIRECTORY "${root}")
  file(LOCK "${root}/lock" GUARD FUNCTION TIMEOUT 600)
  if(EXISTS "${unpacked}/usr")
    set(${out_dir} "${unpacked}" PARENT_SCOPE)
    return()
  endif()

  set(${out_dir} "" PARENT_SCOPE)
  find_program(APT_GET apt-get)
  find_program(DPKG_DEB dpkg-deb)
  if(NOT APT_GET OR NOT DPKG_DEB OR NOT EXISTS "${DEBIAN_KEYRING}")
    set(${out_dir}_error "apt-get, dpkg-deb and ${DEBIAN_KEYRING} are needed to fetch it" PARENT_SCOPE)
    return()
  endif()

  message(STATUS "Fetching ${name} from the Debian archive (once)")
  set(downloads "${root}/download")
  file(MAKE_DIRECTORY "${root}/lists/partial" "${root}/cache/archives/partial" "${downloads}")
  set(apt "${APT_GET}" -q
    "-oDir::Etc::SourceList=${root}/sources.list" -oDir::Etc::SourceParts=/dev/null
    "-oDir::State::Lists=${root}/lists" "-oDir::Cache=${root}/cache"
    -oAcquire::Languages=none -oAcquire::Retries=3 -oAPT::Sandbox::User=root)
  execute_process(
    COMMAND "${APT_GET}" indextargets --format "$(REPO_URI)" "Created-By: Packages"
    OUTPUT_VARIABLE mirrors ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  string(REPLACE "\n" ";" mirrors "${mirrors}")
  list(REMOVE_DUPLICATES mirrors)
  list(FILTER mirrors EXCLUDE REGEX "security")

  foreach(mirror IN LISTS mirrors)
    file(WRITE "${root}/sources.list" "deb [signed-by=${DEBIAN_KEYRING}] ${mirror} ${DEBIAN_SUITE} main\n")
    execute_process(COMMAND ${apt} update -oAPT::Update::Error-Mode=any
      RESULT_VARIABLE status OUTPUT_VARIABLE log ERROR_VARIABLE log TIMEOUT 300)
    if(status EQUAL 0)
      execute_process(COMMAND ${apt} download ${name} WORKING_DIRECTORY "${downloads}"
        RESULT_VARIABLE status OUTPUT_VARIABLE log ERROR_VARIABLE log TIMEOUT 300)
    endif()
    file(GLOB archive "${downloads}/${name}_*.deb")
    if(status EQUAL 0 AND archive)
      list(GET archive 0 archive)
      execute_process(COMMAND "${DPKG_DEB}" -x "${archive}" "${unpacked}.partial" RESULT_VARIABLE status ERROR_VARIABLE log)
      if(status EQUAL 0)
        file(RENAME "${unpacked}.partial" "${unpacked}")
        file(REMOVE_RECURSE "${downloads}" "${root}/lists" "${root}/cache")
        set(${out_dir} "${unpacked}" PARENT_SCOPE)
        return()
      endif()
    endif()
  endforeach()
  set(${out_dir}_error "no Debian mirror of this machine's apt gave it: ${log}" PARENT_SCOPE)
endfunction()
