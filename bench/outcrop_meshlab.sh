#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# MeshLab's quadric edge collapse with texture coordinates, beside ours (Debian: meshlab, xvfb). Its OBJ reader stops at an
# assertion on meshes like these, so it gets a PLY.
#
#   outcrop_meshlab.sh MESH FOLDER PERCENT...    writes FOLDER/meshlab_PERCENT.obj, simplified by so much
#   bench_outcrop error MESH FOLDER
#
# LODESTONE=PROGRAM names another than build/release/cli/lodestone.
set -euo pipefail
lodestone=${LODESTONE:-build/release/cli/lodestone}
folder=$(realpath "$2")
"$lodestone" convert "$1" -o "$folder/source.ply" --quiet >/dev/null
shift 2
for percent in "$@"; do
  left=$(python3 -c "print(1 - $percent / 100)")
  cat >"$folder/script.mlx" <<XML
<!DOCTYPE FilterScript>
<FilterScript>
 <filter name="Convert PerVertex UV into PerWedge UV"/>
 <filter name="Simplification: Quadric Edge Collapse Decimation (with texture)">
  <Param type="RichInt" value="0" name="TargetFaceNum"/>
  <Param type="RichFloat" value="$left" name="TargetPerc"/>
  <Param type="RichFloat" value="0.3" name="QualityThr"/>
  <Param type="RichFloat" value="1" name="Extratcoordw"/>
  <Param type="RichBool" value="false" name="PreserveBoundary"/>
  <Param type="RichFloat" value="1" name="BoundaryWeight"/>
  <Param type="RichBool" value="true" name="OptimalPlacement"/>
  <Param type="RichBool" value="false" name="PreserveNormal"/>
  <Param type="RichBool" value="false" name="PlanarQuadric"/>
  <Param type="RichBool" value="false" name="Selected"/>
 </filter>
</FilterScript>
XML
  xvfb-run -a meshlabserver -i "$folder/source.ply" -o "$folder/meshlab_$percent.obj" -m wt -s "$folder/script.mlx" \
    >"$folder/meshlab.log" 2>&1 || { tail -5 "$folder/meshlab.log" >&2; exit 1; }
  sed -i '/^mtllib/d' "$folder/meshlab_$percent.obj"  # it is shown with the source's texture
done
rm -r "$folder"/source.ply "$folder"/source_textures "$folder/script.mlx" "$folder/meshlab.log" "$folder"/*.obj.mtl
