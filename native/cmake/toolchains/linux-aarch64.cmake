# Linux on 64-bit ARM, with the C library of Debian 11.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(zig_target aarch64-linux-gnu.2.31)
include("${CMAKE_CURRENT_LIST_DIR}/zig.cmake")
