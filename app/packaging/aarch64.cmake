# SPDX-License-Identifier: MIT
# Toolchain of the packages for arm64 (app/package.sh --arch arm64): Debian's cross compiler, libraries of the folder
# THERMORIG_SYSROOT (sysroot.sh), and an emulator for the program, which writes its man pages itself. A file of its own,
# since CMake reads it before the project and again for each trial compilation.
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES THERMORIG_SYSROOT)
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_SYSROOT ${THERMORIG_SYSROOT})
set(CMAKE_FIND_ROOT_PATH ${THERMORIG_SYSROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
foreach(what LIBRARY INCLUDE PACKAGE)
  set(CMAKE_FIND_ROOT_PATH_MODE_${what} ONLY)
endforeach()
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -L ${THERMORIG_SYSROOT})
set(HDF5_C_COMPILER_EXECUTABLE false CACHE STRING "") # h5cc would name this computer's own library
set(CMAKE_LIBRARY_PATH ${THERMORIG_SYSROOT}/usr/lib/aarch64-linux-gnu/hdf5/serial)
set(CMAKE_INCLUDE_PATH ${THERMORIG_SYSROOT}/usr/include/hdf5/serial)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${THERMORIG_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR} ${THERMORIG_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${THERMORIG_SYSROOT}/usr/share/pkgconfig)
