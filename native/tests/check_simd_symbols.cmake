# Fails if a kernel compiled for a newer instruction set defines a symbol that the linker could share with other code.

execute_process(COMMAND "${NM}" -A -C --defined-only "${ARCHIVE}" OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[^\n]+" symbols "${symbols}")
list(FILTER symbols INCLUDE REGEX "(splat|noise|bounce|sobol)_(avx2|avx512)\\.cpp\\.o:")
if(NOT symbols)
  message(FATAL_ERROR "${ARCHIVE} holds no AVX kernels.")
endif()
# W, V: weak (inline functions, templates); u: unique global.
list(FILTER symbols INCLUDE REGEX ":[0-9a-f]* [WVu] ")
if(symbols)
  list(JOIN symbols "\n" symbols)
  message(FATAL_ERROR "Symbols that an AVX kernel must not define:\n${symbols}")
endif()
