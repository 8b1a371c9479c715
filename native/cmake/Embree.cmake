# Embree 4 as Blender ships it: target photon_splat_embree.
#
# Headers: EMBREE_INCLUDE_DIR, an option or of the environment, else find_package(embree 4), else Debian's libembree-dev.
# Library: EMBREE_LIBRARY, else the one of the bpy package of this Python, else find_package's; for another system a stub of
# the functions that the headers declare. It is linked by its name only: at run time the process binds to the Embree that
# Blender has loaded.

set(EMBREE_INCLUDE_DIR "$ENV{EMBREE_INCLUDE_DIR}" CACHE PATH "Folder that holds embree4/rtcore.h")
set(EMBREE_LIBRARY "" CACHE FILEPATH "Shared library of Embree 4 to link to")

if(NOT CMAKE_CROSSCOMPILING AND NOT (EMBREE_INCLUDE_DIR AND EMBREE_LIBRARY))
  find_package(embree 4 CONFIG QUIET)
endif()

if(NOT EMBREE_INCLUDE_DIR)
  if(TARGET embree)
    get_target_property(found embree INTERFACE_INCLUDE_DIRECTORIES)
    if(NOT found)
      find_path(found embree4/rtcore.h)
    endif()
  else()
    include(DebianPackage)
    photon_splat_fetch_debian_package(libembree-dev package)
    if(NOT package)
      message(FATAL_ERROR
        "The headers of Embree 4 were not found (${package_error}). Install them, or give their folder as -DEMBREE_INCLUDE_DIR=...")
    endif()
    set(found "${package}/usr/include")
  endif()
  set(EMBREE_INCLUDE_DIR "${found}" CACHE PATH "Folder that holds embree4/rtcore.h" FORCE)
endif()

if(NOT EMBREE_LIBRARY AND CMAKE_CROSSCOMPILING)
  include(EmbreeStub)
  photon_splat_embree_stub("${EMBREE_INCLUDE_DIR}" found)
  set(EMBREE_LIBRARY "${found}" CACHE FILEPATH "Shared library of Embree 4 to link to" FORCE)
elseif(NOT EMBREE_LIBRARY)
  execute_process(
    COMMAND "${Python_EXECUTABLE}" "${CMAKE_CURRENT_LIST_DIR}/find_bpy_embree.py"
    OUTPUT_VARIABLE found OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT found AND TARGET embree)
    set(found "$<TARGET_FILE:embree>")
  elseif(NOT found)
    message(FATAL_ERROR
      "Embree 4's library was not found: install the bpy package for ${Python_EXECUTABLE}, or give -DEMBREE_LIBRARY=...")
  endif()
  set(EMBREE_LIBRARY "${found}" CACHE FILEPATH "Shared library of Embree 4 to link to" FORCE)
endif()
message(STATUS "Embree headers: ${EMBREE_INCLUDE_DIR}")
message(STATUS "Embree library: ${EMBREE_LIBRARY}")

add_library(photon_splat_embree INTERFACE)
target_include_directories(photon_splat_embree SYSTEM INTERFACE "${EMBREE_INCLUDE_DIR}")
target_link_libraries(photon_splat_embree INTERFACE "${EMBREE_LIBRARY}")
if(UNIX AND NOT APPLE)
  # Embree's own dependencies (TBB, SYCL) are its business.
  target_link_options(photon_splat_embree INTERFACE -Wl,--allow-shlib-undefined)
endif()
