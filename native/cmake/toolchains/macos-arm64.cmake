# macOS on Apple's processors, from version 11.2 on as Blender is. Compiles and makes libraries; what links to frameworks or to
# Blender's libraries needs a Mac and its own compiler, which need no toolchain file.
set(CMAKE_SYSTEM_NAME Darwin)
set(CMAKE_SYSTEM_PROCESSOR arm64)
set(CMAKE_OSX_ARCHITECTURES arm64)
set(CMAKE_OSX_SYSROOT "")
set(zig_target aarch64-macos.11.2)
include("${CMAKE_CURRENT_LIST_DIR}/zig.cmake")
