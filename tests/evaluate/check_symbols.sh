#!/usr/bin/env bash
# check_symbols.sh OBJECT...: the kernels of an instruction set share no function with the rest of the program. A weak or
# global one could be linked into code for other machines, and there be an illegal instruction.
set -euo pipefail
failures=0
for object in "$@"; do
  # Defined and visible: only the tables. An exception's personality is data that every compiler emits.
  shared=$(nm -C --defined-only "$object" | grep -E ' [TWVuDBRi] ' |
    grep -vE ' (__odr_asan|DW\.ref)\.| darboux::kernels::(uv_jet_|mikktspace_)?table_([a-z_]+_)?(baseline|avx2|avx512)$' || true)
  if [[ -n $shared ]]; then
    echo "FAILED: $object shares:" >&2
    echo "$shared" >&2
    failures=$((failures + 1))
  fi
  # Nor do they call the mathematical library, whose bits differ: only sqrt, and roundings, which are exact.
  called=$(nm --undefined-only "$object" | awk '{print $2}' |
    grep -xE '(exp|exp2|expm1|log|log2|log1p|pow|sinh|cosh|tanh|sin|cos|tan|sincos|atan2|hypot|fma|cbrt)[fl]?' || true)
  if [[ -n $called ]]; then
    echo "FAILED: $object calls $called" >&2
    failures=$((failures + 1))
  fi
  tables=$(nm -C --defined-only "$object" | grep -cE 'kernels::(uv_jet_|mikktspace_)?table_' || true)
  [[ $tables -gt 0 ]] || {
    echo "FAILED: $object has no table: is this the right file?" >&2
    failures=$((failures + 1))
  }
done
echo "$# objects, $failures failures"
[[ $# -gt 0 && $failures -eq 0 ]]
