# softfp: the FPU is single precision, so every double goes through a function of core registers; passed in those (hard
# would pass them in the FPU's) the image is 1.2 % smaller.
set(STILLPOINT_CPU_FLAGS "-mcpu=cortex-m4 -mthumb -mfloat-abi=softfp -mfpu=fpv4-sp-d16")
include(${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake)
