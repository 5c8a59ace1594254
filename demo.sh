#!/usr/bin/env bash
# Builds Lightloom and renders the built-in scene with every pipeline into demo-out/. Installs what is missing where it
# may, and measures each against the path tracer. Environment: LOOM_JOBS (parallel jobs), LOOM_DEMO_SIZE (512x512),
# LOOM_DEMO_SAMPLES (4), LOOM_DEMO_SPP (512: paths a pixel of the reference that the error table is made with).
set -uo pipefail
cd "$(dirname "$0")" || exit 1
. framework/cmake/steps.sh

install_packages || exit 1
# The tests are left as they are: test.sh switches them on in the same folder.
options=()
[ -e build/CMakeCache.txt ] || options=(-DLOOM_TESTS=OFF)
step "configuring" configure build "${options[@]}" || exit 1
step "building" cmake --build build --parallel "$jobs" --target lightloom || exit 1

size=${LOOM_DEMO_SIZE:-512x512}
samples=${LOOM_DEMO_SAMPLES:-4}
mkdir -p demo-out
failed=0
for file in pipelines/*.json; do
  name=$(basename "$file" .json)
  step "rendering $name" build/bin/loom render -p "$file" --size "$size" --samples "$samples" \
    -o "demo-out/$name.png" --stats "demo-out/$name.stats.json" || failed=1
done

# The error table: hdr and indirect against the path tracer, at a size that is quick to trace.
table=demo-out/errors.md
table_size=128x128
step "tracing the reference" build/bin/loom reference -o demo-out/reference.exr --size "$table_size" \
  --spp "${LOOM_DEMO_SPP:-512}" || failed=1
value() { grep -oE "\"$1\": *[-+0-9.eE]+" | head -n 1 | sed 's/.*: *//'; }
rows() {
  echo "| pipeline | hdr relMSE | indirect relMSE | indirect mean ratio | frame, ms |"
  echo "|---|---|---|---|---|"
  local file name output json row
  for file in pipelines/*.json; do
    name=$(basename "$file" .json)
    grep -q '"hdr":' "$file" && [ "$name" != reference ] || continue
    row="| $name |"
    for output in hdr indirect; do
      build/bin/loom render -p "$file" --size "$table_size" --samples 4 --output "$output" \
        -o "demo-out/$name.$output.exr" --stats "demo-out/$name.table.json" >&2 || return 1
      json=$(build/bin/loom compare "demo-out/$name.$output.exr" demo-out/reference.exr --json) || return 1
      row+=" $(printf '%.3g' "$(value relmse <<<"$json")") |"
      if [ "$output" = hdr ]; then
        frame=$(value wall_ms <"demo-out/$name.table.json")
      else
        row+=" $(printf '%.2f' "$(value mean_ratio <<<"$json")") | $(printf '%.3g' "$frame") |"
      fi
    done
    echo "$row"
  done
  echo
  echo "Built-in Cornell box, $table_size, 4 samples a pixel; reference: ${LOOM_DEMO_SPP:-512} paths a pixel; ms: median of a sub-frame."
  echo "Device: $(grep -oE '"device": *"[^"]*"' demo-out/direct.table.json | sed 's/.*: *//')"
}
write_table() { rows >"$table.new" && mv "$table.new" "$table"; }
step "measuring errors" write_table || failed=1

echo
echo "pictures:     $PWD/demo-out/*.png"
echo "times:        $PWD/demo-out/*.stats.json"
echo "error table:  $PWD/$table"
exit "$failed"
