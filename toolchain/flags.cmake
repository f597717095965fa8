# The flags of every target, in one place. `stillpoint_flags`: all code. `stillpoint_freestanding`: shaper, hal,
# firmware, which have no C++ library under them, on any machine.
add_library(stillpoint_flags INTERFACE)
target_include_directories(stillpoint_flags INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(stillpoint_flags INTERFACE
  -Wall -Wextra -Werror -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wundef -Wcast-align
  -Wold-style-cast -Wnon-virtual-dtor -Woverloaded-virtual -Wnull-dereference -Wimplicit-fallthrough -Wformat=2
  -ffp-contract=off)
if(STILLPOINT_SANITIZE)
  target_compile_options(stillpoint_flags INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=all
    -fno-omit-frame-pointer)
  target_link_options(stillpoint_flags INTERFACE -fsanitize=address,undefined)
endif()

add_library(stillpoint_freestanding INTERFACE)
target_link_libraries(stillpoint_freestanding INTERFACE stillpoint_flags)
target_compile_options(stillpoint_freestanding INTERFACE
  -ffreestanding -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-math-errno -Wdouble-promotion)
if(CMAKE_CROSSCOMPILING)
  target_compile_options(stillpoint_freestanding INTERFACE
    -Os -ffunction-sections -fdata-sections -fno-unwind-tables -fno-asynchronous-unwind-tables -fcallgraph-info=su)
  # Leaves out what costs size and gains nothing; shaper/CMakeLists.txt has the exception.
  target_compile_options(stillpoint_freestanding INTERFACE
    -fno-move-loop-invariants -fno-tree-loop-im -fno-reorder-blocks -fno-schedule-insns2)
  target_link_options(stillpoint_freestanding INTERFACE -nostdlib -fno-lto -Wl,--gc-sections)
  # The compiler's own helpers (64-bit and soft-float arithmetic): last in every link, whatever the order of libraries.
  set(CMAKE_CXX_STANDARD_LIBRARIES -lgcc)
endif()

# `stillpoint_whole`: objects that can be linked as they are, as every user of the library does, or optimised once more
# as one by an image that links `stillpoint_whole_image`, as the drive's do: 5 % smaller.
add_library(stillpoint_whole INTERFACE)
add_library(stillpoint_whole_image INTERFACE)
if(STILLPOINT_TARGET)
  target_compile_options(stillpoint_whole INTERFACE -flto -ffat-lto-objects)
  target_link_options(stillpoint_whole_image INTERFACE -flto -flto-partition=one -fcallgraph-info=su)
endif()
