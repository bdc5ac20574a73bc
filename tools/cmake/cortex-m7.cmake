# Toolchain: Arm Cortex-M7 without an operating system, floating point of double precision in hardware.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR cortex-m7)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_EXECUTABLE_SUFFIX_CXX .elf)
# Nothing of the C++ runtime that would bring a heap, exceptions or locks along.
set(CMAKE_CXX_FLAGS_INIT "-mcpu=cortex-m7 -mthumb -mfloat-abi=hard -mfpu=fpv5-d16 -fno-exceptions -fno-rtti \
-fno-threadsafe-statics -fno-use-cxa-atexit -ffunction-sections -fdata-sections -fstack-usage")
# Last on the line: of the C library what copies and sets memory, of the compiler's its long divisions.
set(CMAKE_CXX_STANDARD_LIBRARIES "-lc -lgcc")
