# Sourced by tests that need packages of npm. What cannot be had skips the test, aloud: exit status 77.
skip() {  # skip WHY; `unchecked` says what is not checked then
  echo "SKIPPED: $1; $unchecked"
  exit 77
}
need_npm() {  # need_npm FOLDER PACKAGE@VERSION...: node, with these packages in FOLDER, where its scripts then find them
  local folder=$1
  shift
  command -v node >/dev/null || skip "node is not there"
  if [ "$(cat "$folder/installed" 2>/dev/null)" != "$*" ]; then
    command -v npm >/dev/null || skip "npm is not there"
    mkdir -p "$folder"
    npm install --silent --no-audit --no-fund --ignore-scripts --legacy-peer-deps --prefix "$folder" "$@" >/dev/null 2>&1 ||
      skip "npm cannot install $*"
    echo "$*" >"$folder/installed"
  fi
  export NODE_PATH=$folder/node_modules
}
