# SPDX-License-Identifier: Apache-2.0
# stillpoint_test(<name> SOURCES a.cpp... [HOST_SOURCES b.cpp...] [LIBRARIES lib...] [HOST_ONLY] [RUN_IN tree]
#                 [LEFT_TO_OTHERS case...])
#
# One test program out of Unity-style sources (tests/support/test.hpp), registered with ctest as <build tree>.<name>.
# On the host it is linked with doctest; for the chip the same SOURCES become an image that the emulator runs, unless
# HOST_ONLY. HOST_SOURCES hold cases that need a C++ library, libm or minutes of chip time. RUN_IN: built in all trees,
# run in that one, for what tests the chip's image and not the host's compiler. LEFT_TO_OTHERS: long cases that the tree
# host-clang leaves out: its compiler runs all of them under the sanitizers, the other one in `host`.
#
# stillpoint_chip_image(<target> SOURCES a.cpp... [LIBRARIES lib...])
#
# Such an image for the emulated chip, not registered.
include_guard()

cmake_path(GET PROJECT_BINARY_DIR FILENAME STILLPOINT_TREE)

set(STILLPOINT_EMULATOR timeout -k 5 120 qemu-system-arm -M netduinoplus2 -display none -monitor none -serial none
    -semihosting-config enable=on,target=native)

function(stillpoint_chip_image target)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "SOURCES;LIBRARIES")
  set(chip ${PROJECT_SOURCE_DIR}/firmware/target/${STILLPOINT_TARGET})
  add_executable(${target} ${ARG_SOURCES})
  set_target_properties(${target} PROPERTIES SUFFIX .elf LINK_DEPENDS ${chip}/linker.ld)
  target_link_libraries(${target} PRIVATE ${ARG_LIBRARIES} stillpoint_chip_runner stillpoint_freestanding)
  target_compile_definitions(${target} PRIVATE STILLPOINT_CHIP_TESTS)
  target_link_options(${target} PRIVATE -T ${chip}/linker.ld)
endfunction()

function(stillpoint_test name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "HOST_ONLY" "RUN_IN" "SOURCES;HOST_SOURCES;LIBRARIES;LEFT_TO_OTHERS")
  set(target test_${name})
  if(NOT CMAKE_CROSSCOMPILING)
    add_executable(${target} ${ARG_SOURCES} ${ARG_HOST_SOURCES})
    target_link_libraries(${target} PRIVATE ${ARG_LIBRARIES} stillpoint_doctest_main stillpoint_flags)
    # GCC's -O3 takes a fifth longer than -O2 to compile tests and gains nothing in running them.
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O2>)
    if(NOT ARG_RUN_IN OR ARG_RUN_IN STREQUAL STILLPOINT_TREE)
      set(left_out)
      if(ARG_LEFT_TO_OTHERS AND STILLPOINT_TREE STREQUAL host-clang)
        list(JOIN ARG_LEFT_TO_OTHERS "," cases)
        set(left_out --test-case-exclude=${cases})
      endif()
      add_test(NAME ${STILLPOINT_TREE}.${name} COMMAND ${target} ${left_out})
      set_tests_properties(${STILLPOINT_TREE}.${name} PROPERTIES TIMEOUT 600)
    endif()
  elseif(STILLPOINT_TARGET AND NOT ARG_HOST_ONLY)
    stillpoint_chip_image(${target} SOURCES ${ARG_SOURCES} LIBRARIES ${ARG_LIBRARIES})
      add_test(NAME ${STILLPOINT_TREE}.${name} COMMAND ${STILLPOINT_EMULATOR} -kernel $<TARGET_FILE:${target}>)
  endif()
endfunction()

if(NOT CMAKE_CROSSCOMPILING)
  find_package(doctest REQUIRED)
  add_library(stillpoint_doctest_main OBJECT ${CMAKE_CURRENT_LIST_DIR}/doctest_main.cpp)
  target_link_libraries(stillpoint_doctest_main PUBLIC doctest::doctest PRIVATE stillpoint_flags)
elseif(STILLPOINT_TARGET)
  set(chip ${PROJECT_SOURCE_DIR}/firmware/target/${STILLPOINT_TARGET})
  add_library(stillpoint_chip_runner OBJECT ${CMAKE_CURRENT_LIST_DIR}/chip_runner.cpp ${chip}/startup.cpp
              ${chip}/memory.cpp)
  target_link_libraries(stillpoint_chip_runner PRIVATE stillpoint_freestanding)
endif()
