# SPDX-License-Identifier: Apache-2.0
# Build for aarch64 with Debian's cross compiler and the sysroot of make_sysroot; programs run under QEMU's user emulation. Used
# by the preset `arm`; IFOG_ARM_SYSROOT is the path of the sysroot.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES IFOG_ARM_SYSROOT)
if(NOT IFOG_ARM_SYSROOT)
  message(FATAL_ERROR "IFOG_ARM_SYSROOT is not set, expected the folder that tests/system/arm/make_sysroot has made")
endif()
set(CMAKE_SYSROOT "${IFOG_ARM_SYSROOT}")
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static -L "${IFOG_ARM_SYSROOT}")

# Libraries and headers are those of the target, programs those of this machine.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} "${IFOG_ARM_SYSROOT}")
set(ENV{PKG_CONFIG_LIBDIR} "${IFOG_ARM_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${IFOG_ARM_SYSROOT}/usr/share/pkgconfig")
# For the packages: where dpkg-shlibdeps finds the libraries; make_sysroot's list has their packages.
set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${IFOG_ARM_SYSROOT}/usr/lib/aarch64-linux-gnu")
