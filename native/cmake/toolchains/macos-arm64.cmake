# macOS on Apple's processors, from version 11.2 on as Blender is: to see that the code compiles. zig links programs and
# libraries for it, and no modules that Python loads: their objects are put in an archive. What is to run is built on a Mac by
# its own compiler, which needs no toolchain file.
set(CMAKE_SYSTEM_NAME Darwin)
set(CMAKE_SYSTEM_PROCESSOR arm64)
set(CMAKE_OSX_ARCHITECTURES arm64)
set(CMAKE_OSX_SYSROOT "")
set(zig_target aarch64-macos.11.2)
include("${CMAKE_CURRENT_LIST_DIR}/zig.cmake")
