# What every target of the project is compiled with, as an interface target: no global flags.

find_program(AERATE_CCACHE ccache)
if(AERATE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${AERATE_CCACHE}")
endif()

# -std=c++20, not gnu++20. A property of the targets made from here on: consumers of an interface target would not
# take it over.
if(NOT DEFINED CMAKE_CXX_EXTENSIONS)
  set(CMAKE_CXX_EXTENSIONS OFF)
endif()

add_library(aerate_options INTERFACE)
target_compile_features(aerate_options INTERFACE cxx_std_20)
target_include_directories(aerate_options INTERFACE
  "${PROJECT_SOURCE_DIR}" "${PROJECT_SOURCE_DIR}/src")

# No contraction of a*b+c: the CPU and CUDA executors must give the same bytes (docs/design.md).
target_compile_options(aerate_options INTERFACE
  $<$<COMPILE_LANG_AND_ID:CXX,GNU,Clang>:-ffp-contract=off -Wall -Wextra -Wpedantic -Wshadow -Wconversion
    -Wsign-conversion -Wnon-virtual-dtor -Woverloaded-virtual -Wnull-dereference -Wdouble-promotion>)

if(AERATE_SANITIZE)
  set(sanitize "-fsanitize=${AERATE_SANITIZE}" -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_compile_options(aerate_options INTERFACE "$<$<COMPILE_LANGUAGE:CXX>:${sanitize}>")
  target_link_options(aerate_options INTERFACE "-fsanitize=${AERATE_SANITIZE}")
  if(AERATE_SANITIZE STREQUAL "thread")
    target_compile_definitions(aerate_options INTERFACE TBB_USE_PROFILING_TOOLS=2)  # tests/tsan/tbb_edges.cpp
  endif()
endif()

# aerate_add_library(NAME sources...): a static library of the project with its common options. Position-independent, for the
# Python module (src/python) is a shared object; functions are inlined as in a program all the same.
function(aerate_add_library name)
  add_library(${name} STATIC ${ARGN})
  target_link_libraries(${name} PUBLIC aerate_options)
  set_target_properties(${name} PROPERTIES
    POSITION_INDEPENDENT_CODE ON
    UNITY_BUILD ${AERATE_UNITY_BUILD}
    UNITY_BUILD_BATCH_SIZE 8)
  if(AERATE_UNITY_BUILD)
    # To the compiler the sources are headers of the batch.
    target_compile_options(${name} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>)
  endif()
  target_compile_options(${name} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU,Clang>:-fno-semantic-interposition>)
endfunction()
