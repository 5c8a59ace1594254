#!/usr/bin/env bash
# Everything that must hold: release build and its fast tests, formatting, clang-tidy, then the same tests under
# AddressSanitizer and UndefinedBehaviorSanitizer. Quiet unless something fails, quick when run again.
#
# Environment
#   LOOM_JOBS=n          parallel jobs; default: the number of processors
#   LOOM_TESTS=regex     only the tests whose names match (ctest -R)
#   LOOM_SANITIZE=0      leave out the sanitized build
#   LOOM_TIDY=0          leave out clang-tidy
#   LOOM_TIDY_FILES=re   files that clang-tidy looks at, by path; default ^passes/, since the whole tree takes long.
#                        Clean files are remembered in build/
#   LOOM_TIDY_SECONDS=n  time for clang-tidy, 300; files with changes come first, what is not reached is counted
#   LOOM_SCENES=folder   scenes that are not shipped; default ../shared/scenes. Tests that need them skip without
set -uo pipefail
cd "$(dirname "$0")" || exit 1
. framework/cmake/steps.sh

install_packages test || exit 1

failures=()
passed=0 failed=0 skipped=0
# failed_output LOG: what the failing tests in it said, 40 lines each of the first five. It is printed once more at the
# end, where a log that was cut off at its beginning still has it.
failed_output() {
  awk '/^ *[0-9]+\/[0-9]+ Test +#/ { shown = /\*\*\*/ && !/\*\*\*Skipped/ && ++count <= 5; lines = 0 }
       /^ +Start +[0-9]+:/ || /tests passed, / { shown = 0 }
       shown && ++lines <= 40' "$1"
}
said=
# run_tests FOLDER: the fast tests of that build; what passed, failed and was skipped is added up for the last line.
run_tests() {
  local log
  step "tests in $1" ctest --test-dir "$1" --output-on-failure --parallel "$jobs" --label-exclude slow \
    --no-tests=error ${LOOM_TESTS:+-R "$LOOM_TESTS"} || failures+=("tests in $1")
  log=$logs/$(printf '%s' "tests in $1" | tr -cs 'a-zA-Z0-9' '-').log
  local total broken left_out
  said+=$(failed_output "$log")
  read -r broken total < <(sed -n 's/.*tests passed, \([0-9]*\) tests\{0,1\} failed out of \([0-9]*\).*/\1 \2/p' "$log")
  left_out=$(grep -c '(Skipped)$' "$log")
  failed=$((failed + ${broken:-0})) skipped=$((skipped + left_out))
  passed=$((passed + ${total:-0} - ${broken:-0} - left_out))
  if [ "$left_out" -gt 0 ]; then
    echo "skipped in $1, for want of something named in the test's message (ctest --test-dir $1 -V):"
    grep '(Skipped)$' "$log" | sed 's/^/  /' | head -n 20
  fi
}

step "configuring" configure build -DLOOM_TESTS=ON || exit 1
step "building" cmake --build build --parallel "$jobs" || exit 1
run_tests build
step "formatting" tests/tools/format_check.sh || failures+=("formatting")
if [ "${LOOM_TIDY:-1}" != 0 ]; then
  step "clang-tidy" python3 tests/tools/tidy.py --build build --jobs "$jobs" --seconds "${LOOM_TIDY_SECONDS:-300}" \
    --filter "${LOOM_TIDY_FILES-^passes/}" ||
    failures+=("clang-tidy")
  tail -n 1 "$logs/clang-tidy.log"
fi
if [ "${LOOM_SANITIZE:-1}" != 0 ]; then
  step "configuring with sanitizers" configure build-sanitize -DLOOM_TESTS=ON -DLOOM_SANITIZE=ON \
    -DCMAKE_BUILD_TYPE=RelWithDebInfo || exit 1
  step "building with sanitizers" cmake --build build-sanitize --parallel "$jobs" || exit 1
  run_tests build-sanitize
fi

echo
if [ ${#failures[@]} -gt 0 ]; then
  [ -n "$said" ] && printf '%s\n\n' "$said"
  printf 'failed: %s\n' "${failures[@]}"
fi
echo "$passed passed, $failed failed, $skipped skipped"
[ ${#failures[@]} -eq 0 ]
