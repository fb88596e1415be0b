#!/usr/bin/env bash
# check_symbols.sh OBJECT...: the kernels of an instruction set share no function with the rest of the program. A weak or
# global one could be linked into code for other machines, and there be an illegal instruction.
set -euo pipefail
failures=0
for object in "$@"; do
  # Defined and visible: only the table. An exception's personality is data that every compiler emits.
  shared=$(nm -C --defined-only "$object" | grep -E ' [TWVuDBRi] ' | grep -vE ' DW\.ref\.|kernels::table_' || true)
  if [[ -n $shared ]]; then
    echo "FAILED: $object shares:" >&2
    echo "$shared" >&2
    failures=$((failures + 1))
  fi
  tables=$(nm -C --defined-only "$object" | grep -c 'kernels::table_' || true)
  [[ $tables -gt 0 ]] || {
    echo "FAILED: $object has no table: is this the right file?" >&2
    failures=$((failures + 1))
  }
done
echo "$# objects, $failures failures"
[[ $# -gt 0 && $failures -eq 0 ]]
