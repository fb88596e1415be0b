#!/bin/sh
# The mutation run over surfaces/: tests/mutation/run.py, which needs python3 and nothing else of it.
command -v python3 > /dev/null || { echo "tests/mutation/run.py needs python3 (3.9 or newer), which is not installed" >&2; exit 2; }
exec python3 "$(dirname "$0")/run.py" "$@"
