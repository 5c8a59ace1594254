#!/usr/bin/env bash
# What each pipeline costs and how far it is from the path tracer: a Markdown table on stdout, one row for each scene and
# pipeline. References and finished rows are kept in the folder, so that a run that was stopped goes on where it was; a
# row is measured again where the program, the shaders, its scene or its pipeline has changed since.
#
#   configs/table.sh [-o FOLDER] [--scene SCENE]... [--pipeline PIPELINE]... [--size WxH] [--spp N] [--samples N]
#
#   -o FOLDER   default table-out
#   --scene     a shipped name, a glTF or run file; default: cornell-box, cornell-box-emissive, and with LOOM_SCENES set
#               living-room and sponza
#   --pipeline  a shipped name or a file; default: all methods in pipelines/
#   --size      default 128x128, for scenes below LOOM_SCENES 160x90
#   --spp       paths a pixel of the references, 512
#   --samples   sub-pixel samples of the pipelines, 4
#   LOOM        the program, build/bin/loom
set -uo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)

usage() {
  sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0" >&2
  exit 2
}
folder=table-out size='' spp=512 samples=4 scenes=() pipelines=()
while [ $# -gt 0 ]; do
  [ $# -ge 2 ] || usage
  case $1 in
    -o) folder=$2 ;;
    --scene) scenes+=("$2") ;;
    --pipeline) pipelines+=("$2") ;;
    --size) size=$2 ;;
    --spp) spp=$2 ;;
    --samples) samples=$2 ;;
    *) usage ;;
  esac
  shift 2
done
loom=${LOOM:-$top/build/bin/loom}
[ -x "$loom" ] || {
  echo "There is no $loom: build it (./demo.sh does), or name it in the variable LOOM." >&2
  exit 2
}
if [ ${#scenes[@]} -eq 0 ]; then
  scenes=(cornell-box cornell-box-emissive)
  for name in living-room sponza; do
    # The run file says where below LOOM_SCENES its scene lies.
    # shellcheck disable=SC2016
    place=$(sed -n 's/.*"scene": *"${LOOM_SCENES}\/\([^"]*\)".*/\1/p' "$top/configs/runs/$name.json")
    [ -n "${LOOM_SCENES:-}" ] && [ -e "$LOOM_SCENES/$place" ] && scenes+=("$name")
  done
fi
if [ ${#pipelines[@]} -eq 0 ]; then
  for file in "$top"/pipelines/*.json; do
    # The reference is what the others are measured against, the views of the G-buffer are no method.
    case $(basename "$file") in
      reference.json | gbuffer.json) ;;
      *) pipelines+=("$file") ;;
    esac
  done
fi
mkdir -p "$folder/rows" || exit 1

say() { echo "$*" >&2; }
# value KEY <JSON: the first number of that name.
value() { grep -oE "\"$1\": *[-+0-9.eE]+" | head -n 1 | sed 's/.*: *//'; }
# number FORMAT KEY <JSON: the same for people; a dash where it has no value.
number() {
  local found
  found=$(value "$2")
  # shellcheck disable=SC2059
  if [ -n "$found" ]; then printf "$1" "$found"; else printf -- '–'; fi
}
run_file() { if [ -e "$1" ]; then echo "$1"; else echo "$top/configs/runs/$1.json"; fi; }
size_of() {
  if [ -n "$size" ]; then
    echo "$size"
  elif grep -q 'LOOM_SCENES' "$(run_file "$1")"; then
    echo 160x90
  else
    echo 128x128
  fi
}
name_of() { basename "$1" | sed 's/\.[a-z]*$//'; }

# Everything that a row's figures come from, apart from its scene: the program, its libraries and plugins, and what they
# read. Pipelines may extend others, so that all of them count.
root=$(cd "$(dirname "$loom")/.." && pwd)
code=$(find "$loom" "$root"/lib "$top"/shaders "$top"/pipelines -type f ! -path '*/cmake/*' -print0 2>/dev/null |
  sort -z | xargs -0 cat | cksum)

# row SCENE PIPELINE REFERENCE: measures and prints one row.
row() {
  local scene=$1 pipeline=$2 reference=$3 pixels output json hdr='' base
  pixels=$(size_of "$scene")
  base=$folder/$(name_of "$scene")-$(name_of "$pipeline")
  for output in hdr indirect; do
    "$loom" render "$scene" -p "$pipeline" --size "$pixels" --samples "$samples" --output "$output" \
      -o "$base.$output.exr" --stats "$base.$output.json" >&2 || return 1
    json=$("$loom" compare "$base.$output.exr" "$reference" --json) || return 1
    [ "$output" = hdr ] && hdr=$(number %.3g relmse <<<"$json")
  done
  printf '| %s | %s | %s | %s | %s | %s | %s | %s |\n' "$(name_of "$scene")" "$(name_of "$pipeline")" "$hdr" \
    "$(number %.3g relmse <<<"$json")" "$(number %.2f mean_ratio <<<"$json")" "$(number %.3f flip <<<"$json")" \
    "$(number %.3g wall_ms <"$base.hdr.json")" \
    "$(awk -v b="$(value textures_bytes <"$base.hdr.json")" 'BEGIN { printf "%.1f", b / 1048576 }')"
}

failed=0
echo "| scene | pipeline | hdr relMSE | indirect relMSE | indirect mean ratio | indirect FLIP | frame, ms | memory, MiB |"
echo "|---|---|---|---|---|---|---|---|"
for scene in "${scenes[@]}"; do
  reference=$folder/$(name_of "$scene")-$(size_of "$scene")-$spp.reference.exr
  # Goes on where it was stopped; at once where it is finished.
  say "reference of $scene, $(size_of "$scene"), $spp paths a pixel"
  "$loom" reference "$scene" -o "$reference" --size "$(size_of "$scene")" --spp "$spp" >&2 || {
    failed=1
    continue
  }
  for pipeline in "${pipelines[@]}"; do
    key=$(printf '%s\n' "$code" "$(cat "$(run_file "$scene")" "$pipeline" "$reference" 2>/dev/null | cksum)" \
      "$samples" | cksum | tr ' ' -)
    kept=$folder/rows/$(name_of "$scene")-$(name_of "$pipeline")-$key.md
    if [ ! -s "$kept" ]; then
      say "$scene, $(name_of "$pipeline")"
      if row "$scene" "$pipeline" "$reference" >"$kept.new"; then
        mv "$kept.new" "$kept"
      else
        rm -f "$kept.new"
        failed=1
        continue
      fi
    fi
    cat "$kept"
  done
done
echo
echo "relMSE, mean ratio and FLIP against $spp paths a pixel; $samples samples a pixel; ms: median of one sample's frame."
device=$(cat "$folder"/*.hdr.json 2>/dev/null | grep -oE '"device": *"[^"]*"' | sort -u | sed 's/.*: *"\(.*\)"/\1/')
echo "Sizes: $(for scene in "${scenes[@]}"; do printf '%s %s, ' "$(name_of "$scene")" "$(size_of "$scene")"; done | sed 's/, $//'). Device: $device."
exit "$failed"
