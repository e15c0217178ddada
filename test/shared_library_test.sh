#!/usr/bin/env bash
# Usage: shared_library_test.sh LIBRARY
# The shared library shows Plumbline's own symbols, under their version, and no others.
set -euo pipefail

symbols=$(nm --dynamic --defined-only --demangle "$1")
strangers=$(grep -v '@@PLUMBLINE_' <<<"$symbols" | grep -v ' A PLUMBLINE_' || true)
if [[ -n $strangers ]]; then
  echo "without a version:"
  head -20 <<<"$strangers"
  exit 1
fi
for wanted in 'plumbline::Solve(' 'plumbline::SlamGraph::AddScan(' 'plumbline::SeedGraph('; do
  grep -qF "$wanted" <<<"$symbols" || { echo "missing: $wanted)"; exit 1; }
done
