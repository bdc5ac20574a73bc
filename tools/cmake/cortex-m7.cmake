# SPDX-License-Identifier: Apache-2.0
# Toolchain: Arm Cortex-M7 without an operating system, double-precision floating point in hardware.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR cortex-m7)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_EXECUTABLE_SUFFIX_CXX .elf)
# Excludes the parts of the C++ runtime that need a heap, exceptions or locks. A loop over seven joints stays a loop: a call
# of memset or memcpy costs more instructions.
set(CMAKE_CXX_FLAGS_INIT "-mcpu=cortex-m7 -mthumb -mfloat-abi=hard -mfpu=fpv5-d16 -fno-exceptions -fno-rtti \
-fno-threadsafe-statics -fno-use-cxa-atexit -fno-tree-loop-distribute-patterns -ffunction-sections -fdata-sections -fstack-usage")
# Last on the link line: libc copies and sets memory, libgcc divides 64-bit integers.
set(CMAKE_CXX_STANDARD_LIBRARIES "-lc -lgcc")
