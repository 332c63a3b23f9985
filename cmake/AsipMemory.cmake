# SPDX-License-Identifier: Apache-2.0
# How the memory of this machine is used for compiling. Included before the first target.
#
# Where it is enough for all compilers that run side by side, up to forty sources are compiled as one and the compiler collects
# no garbage before it has 1 GiB: asipctl takes it 1.0 s a source and 1522 MiB. Else four, and 64 MiB that grow by 30 % at a
# time: some 720 MiB for the largest with the optimization of packages, so that two compilers of a build stay below 1.5 GB
# together. Four instead of six cost 17 % more time, the growth a tenth. g++ 14 takes 836 MiB where the heap may double, and 795
# MiB for one source alone, of the gateway's server.

set(most_memory 1600)   # MiB for each compiler, where there is much
set(least_memory 750)   # where there is little
set(system_memory 300)

cmake_host_system_information(RESULT memory QUERY TOTAL_PHYSICAL_MEMORY)
cmake_host_system_information(RESULT processors QUERY NUMBER_OF_LOGICAL_CORES)
math(EXPR compilers "${processors} + 2") # Ninja's
math(EXPR wanted "${compilers} * ${most_memory} + ${system_memory}")
set(little OFF)
if(memory LESS wanted)
  set(little ON)
endif()
option(ASIP_LITTLE_MEMORY "Compile with little memory: 750 MiB for each compiler, and more time" ${little})

if(ASIP_LITTLE_MEMORY)
  set(ASIP_COMPILER_HEAP 65536) # KiB
  set(ASIP_COMPILER_GROWTH 30) # percent
  set(batch 4)
  math(EXPR possible "(${memory} - ${system_memory}) / ${least_memory}")
  if(possible LESS 1)
    set(possible 1)
  endif()
  if(possible LESS compilers AND NOT DEFINED CMAKE_JOB_POOL_COMPILE)
    set_property(GLOBAL APPEND PROPERTY JOB_POOLS asip_compilers=${possible})
    set(CMAKE_JOB_POOL_COMPILE asip_compilers)
    message(STATUS "${memory} MiB of memory: compilers at a time: ${possible}")
  endif()
else()
  set(ASIP_COMPILER_HEAP 1048576)
  set(ASIP_COMPILER_GROWTH 100)
  set(batch 40)
endif()
if(NOT DEFINED CMAKE_UNITY_BUILD_BATCH_SIZE)
  set(CMAKE_UNITY_BUILD_BATCH_SIZE ${batch})
endif()
