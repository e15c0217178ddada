# For scripts to source.
# changed_since CHECK: lists the C++ files that differ from the commit at which CHECK last passed over
# the whole tree, by test/checks.md, or else from the last commit but one. Fails if neither is known.
changed_since() {
  local root commit
  root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
  commit=$(sed -nE "s/^\| $1 \| passed \| ([0-9a-f]+) \|.*/\1/p" "$root/test/checks.md")
  if [[ -z $commit ]]; then commit=HEAD~1; fi
  if ! git -C "$root" cat-file -e "$commit^{commit}" 2>/dev/null; then return 1; fi
  {
    git -C "$root" diff --name-only --relative --diff-filter=d "$commit"
    git -C "$root" ls-files --others --exclude-standard
  } | grep -E '\.(cc|h)$' || true
}
