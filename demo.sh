#!/usr/bin/env bash
# Builds Lightloom and renders the built-in scene with every pipeline into demo-out/. Installs what is missing where it
# may, and measures each against the path tracer. Environment: LOOM_JOBS (parallel jobs), LOOM_DEMO_SIZE (256x256),
# LOOM_DEMO_SAMPLES (4), LOOM_DEMO_SPP (paths a pixel of the reference that the error table is made with, 8192).
set -uo pipefail
cd "$(dirname "$0")" || exit 1
. framework/cmake/steps.sh

install_packages || exit 1
# The tests are left as they are: test.sh switches them on in the same folder.
options=()
[ -e build/CMakeCache.txt ] || options=(-DLOOM_TESTS=OFF)
step "configuring" configure build "${options[@]}" || exit 1
step "building" cmake --build build --parallel "$jobs" --target lightloom || exit 1

size=${LOOM_DEMO_SIZE:-256x256}
samples=${LOOM_DEMO_SAMPLES:-4}
mkdir -p demo-out
failed=0
for file in pipelines/*.json; do
  name=$(basename "$file" .json)
  step "rendering $name" build/bin/loom render -p "$file" --size "$size" --samples "$samples" \
    -o "demo-out/$name.png" --stats "demo-out/$name.stats.json" || failed=1
done

# The error table: every pipeline against the path tracer, at a size that is quick to trace. Without a reference that is
# ten times better than the best of them the figures mean little, and `loom measure` says so.
table=demo-out/errors.md
measure() {
  build/bin/loom measure configs/sweeps/pipelines.json --scene cornell-box --frames 1 --seeds 1 --no-flicker \
    ${LOOM_DEMO_SPP:+--spp "$LOOM_DEMO_SPP"} -o demo-out/report && cp demo-out/report/report.md "$table"
}
step "measuring errors" measure || failed=1

echo
echo "pictures:     $PWD/demo-out/*.png"
echo "times:        $PWD/demo-out/*.stats.json"
echo "error table:  $PWD/$table"
echo "report:       $PWD/demo-out/report/index.html"
exit "$failed"
