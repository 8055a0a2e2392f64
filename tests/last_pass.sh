# SPDX-License-Identifier: MIT
# Sourced: the last full pass of tests/nightly.sh, for tests/far.sh, the reader of docs/reliability.md, and a release.

# write_last_pass COMMIT DATE: into tests/last_passes.txt, and below its mark in docs/reliability.md.
write_last_pass() {
  local page=docs/reliability.md
  local line="The last full pass of \`bash tests/nightly.sh\` was at commit \`${1:0:12}\`, on $2."
  grep -q '^<!-- last full pass' "$page" || { echo "$page has no place for the last full pass" >&2; return 1; }
  printf '%s\n' everything cortex_m aarch64 usb_guest | sed "s/\$/ $1/" >tests/last_passes.txt
  sed -i "/^<!-- last full pass/{n;s|.*|$line|}" "$page"
}

# last_pass: its commit; nothing where there was none.
last_pass() { sed -n 's/^everything //p' tests/last_passes.txt; }
