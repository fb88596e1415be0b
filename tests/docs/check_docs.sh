#!/usr/bin/env bash
# check_docs.sh SOURCE TOOL_FOLDER EXAMPLES_FOLDER [--update]
#
# Checks README.md, CHANGELOG.md and docs/**/*.md of SOURCE. A comment alone on a line says what the fenced block after
# it is:
#   <!-- example: PATH -->        the whole file PATH (relative to SOURCE), byte for byte
#   <!-- prints: NAME ARGUMENT... -->  the output of the program NAME in EXAMPLES_FOLDER, run like a command below
#   <!-- runs -->                 commands; they must end with status 0, or N with <!-- runs: exit N -->
#   <!-- output -->               what the commands before it print on stdout
#   <!-- not run: WHY -->         commands that only people run
# A cpp, cmake, sh or text block without such a comment is a failure. Commands of one page run one after the other, in
# bash, in one temporary folder that holds tests/data, docs and build/release/bin, with TOOL_FOLDER first in PATH.
#
# Outputs are equal when they are equal after this: numbers below 1e-4 in exponent form, which are rounding noise of the
# float32 data and of the fit, become ~0; runs of spaces become one, spaces at the end of a line none.
#
# Relative links must name a file or folder that exists, and a heading where they name one.
# With --update, blocks that differ are rewritten from the truth; look at the diff.
set -euo pipefail
export LC_ALL=C
root=$(realpath "$1") tool=$(realpath "$2") examples=$(realpath "$3") update=${4:-}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0 blocks=0 links=0

complain() {
  echo "FAILED: $*" >&2
  failures=$((failures + 1))
}

normalise() {
  sed -E -e 's/[-+]?[0-9]+(\.[0-9]+)?e-(0[5-9]|[1-9][0-9]+)/~0/g' -e 's/ +/ /g' -e 's/ $//' "$1"
}

# run STATUS COMMAND: runs it in the page's folder, stdout to $work/out.
run() {
  local status=0
  (cd "$work/page" && PATH="$tool:$PATH" bash -euo pipefail -c "$2") >"$work/out" 2>"$work/err" </dev/null || status=$?
  if [[ $status != "$1" ]]; then
    complain "$page:$line_number: status $status, expected $1, of:"$'\n'"$2"$'\n'"$(head -c 2000 "$work/err")"
  fi
}

# The block just read, in $work/block, against what its comment says; the text that shall stand there to $work/new.
handle_block() {
  blocks=$((blocks + 1))
  cp "$work/block" "$work/new"
  case $marker in
    "example: "*)
      local file=$root/${marker#example: }
      [[ -f $file ]] || { complain "$page:$line_number: ${marker#example: } does not exist"; return; }
      cp "$file" "$work/new"
      cmp -s "$work/block" "$work/new" && return
      ;;
    "prints: "* | output)
      if [[ $marker != output ]]; then
        run 0 "$examples/${marker#prints: }"
      elif [[ $ran != yes ]]; then
        complain "$page:$line_number: output of what? no commands ran before it"
        return
      fi
      cmp -s <(normalise "$work/block") <(normalise "$work/out") && return
      sed -E 's/ +$//' "$work/out" >"$work/new"
      ;;
    runs | "runs: exit "*)
      run "$([[ $marker == runs ]] && echo 0 || echo "${marker#runs: exit }")" "$(cat "$work/block")"
      ran=yes
      return
      ;;
    "not run: "?*) return ;;
    *)
      case $language in
        cpp | cmake | sh | text) complain "$page:$line_number: a $language block without a comment before it" ;;
      esac
      return
      ;;
  esac
  [[ -n $update ]] && return
  complain "$page:$line_number: not as shown ($marker)"
  diff "$work/block" "$work/new" >&2 || true
}

check_blocks() {
  local marker="" language="" fence="" line_number=0 ran=no line
  rm -rf "$work/page"
  mkdir -p "$work/page/tests" "$work/page/build/release"
  ln -s "$root/tests/data" "$work/page/tests/data"
  ln -s "$root/docs" "$work/page/docs"
  ln -s "$tool" "$work/page/build/release/bin"
  : >"$work/rewritten"
  while IFS= read -r line || [[ -n $line ]]; do
    line_number=$((line_number + 1))
    if [[ -n $fence ]]; then
      if [[ $line == "$fence" ]]; then
        handle_block
        cat "$work/new" >>"$work/rewritten"
        fence="" marker=""
      else
        printf '%s\n' "$line" >>"$work/block"
        continue
      fi
    elif [[ $line =~ ^(\`\`\`+)([a-z]*) ]]; then
      fence=${BASH_REMATCH[1]} language=${BASH_REMATCH[2]}
      : >"$work/block"
    elif [[ $line =~ ^'<!-- '(.*)' -->'$ ]]; then
      marker=${BASH_REMATCH[1]}
    elif [[ -n $line ]]; then
      [[ -z $marker ]] || complain "$page:$line_number: no block follows <!-- $marker -->"
      marker=""
    fi
    printf '%s\n' "$line" >>"$work/rewritten"
  done <"$root/$page"
  [[ -z $fence ]] || complain "$page: a block has no end"
  if [[ -n $update ]] && ! cmp -s "$work/rewritten" "$root/$page"; then
    cp "$work/rewritten" "$root/$page"
    echo "rewritten: $page"
  fi
}

# The names that headings of a page have in links, one per line.
anchors() {
  sed -nE 's/^#+ +//p' "$1" | tr '[:upper:]' '[:lower:]' | sed -E -e 's/[^a-z0-9 _-]//g' -e 's/ /-/g'
}
declare -A anchors_of

check_links() {
  local target path anchor folder=$root/$page
  folder=${folder%/*}
  while IFS= read -r target; do
    [[ $target =~ ^(https?|mailto): ]] && continue
    links=$((links + 1))
    path=${target%%#*} anchor=""
    [[ $target == *"#"* ]] && anchor=${target#*#}
    if [[ -z $path ]]; then path=$root/$page; else path=$folder/$path; fi
    if [[ ! -e $path ]]; then
      complain "$page: the link $target names nothing"
    elif [[ -n $anchor ]]; then
      [[ -n ${anchors_of[$path]+known} ]] || anchors_of[$path]=$(anchors "$path")
      [[ $'\n'${anchors_of[$path]}$'\n' == *$'\n'"$anchor"$'\n'* ]] || complain "$page: the link $target names no heading"
    fi
  done < <(sed -E '/^```/,/^```/d' "$root/$page" | grep -oE '\]\([^) ]+\)' | sed -E 's/^\]\(|\)$//g')
}

while IFS= read -r page; do
  check_blocks
  check_links
done < <(cd "$root" && find README.md CHANGELOG.md docs -name '*.md' | sort)

echo "$blocks blocks, $links links, $failures failures"
((blocks > 0)) || { echo "FAILED: no block was found" >&2; exit 1; }
exit $((failures > 0))
