# SPDX-License-Identifier: MIT
# Runs clang-format 14 over every C++ file; other versions lay code out differently and are not asked.
execute_process(COMMAND ${CLANG_FORMAT} --version OUTPUT_VARIABLE version)
if(NOT version MATCHES "version 14\\.")
  message("SKIPPED: this is not clang-format 14: ${version}")
  return()
endif()
execute_process(COMMAND git ls-files *.h *.cpp WORKING_DIRECTORY ${ROOT} OUTPUT_VARIABLE files RESULT_VARIABLE failed
                ERROR_QUIET)
if(failed)
  message("SKIPPED: not a git checkout")
  return()
endif()
string(STRIP "${files}" files)
string(REPLACE "\n" ";" files "${files}")
execute_process(COMMAND ${CLANG_FORMAT} --dry-run --Werror ${files} WORKING_DIRECTORY ${ROOT} RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "run scripts/format.sh")
endif()
