#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Checks that every relative link of the tracked documents (*.md) leads to a tracked file or folder, and its anchor to a
# heading there (GitHub's rule of anchors). Links to other sites are not followed.
# Usage: tools/check_links.sh [--root FOLDER]
# Exit codes: 0 no fault, 1 usage, 5 faults, else the failure of git or perl.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
if [ $# -gt 0 ]; then
  [ $# -eq 2 ] && [ "$1" = --root ] || { echo "usage: check_links.sh [--root FOLDER]" >&2; exit 1; }
  root=$2
fi
cd "$root"
git ls-files -z | perl -e '
use strict;
use warnings;
use utf8;
my (%there, %anchors);
my @files = split /\0/, do { local $/; <STDIN> // "" };
$there{""} = 1;
for my $path (@files) {
  while (length $path) {
    $there{$path} = 1;
    $path =~ s{/?[^/]+$}{};
  }
}

# The lines of a document outside code blocks, with their numbers.
sub prose {
  my ($path) = @_;
  open my $file, "<:encoding(UTF-8)", $path or die "$path: $!";
  my ($code, @lines) = (0);
  while (<$file>) {
    chomp;
    if (/^\s*```/) { $code = !$code; next; }
    push @lines, [$., $_] unless $code || /^    \S/;
  }
  return @lines;
}

sub anchors {
  my ($path) = @_;
  return $anchors{$path} //= do {
    my (%found, %count);
    for (prose($path)) {
      my $line = $_->[1];
      $found{$1} = 1 while $line =~ /<a (?:id|name)="([^"]*)"/g;
      next unless $line =~ /^#{1,6}\s+(.*?)\s*#*$/;
      my $text = lc $1;
      $text =~ s/\[([^\]]*)\]\([^)]*\)/$1/g;
      $text =~ s/[^\w\- ]//g;
      $text =~ s/ /-/g;
      my $n = $count{$text}++;
      $found{$n ? "$text-$n" : $text} = 1;
    }
    \%found;
  };
}

my ($faults, $links) = (0, 0);
for my $path (grep { /\.md$/ && -f } sort keys %there) {
  (my $folder = $path) =~ s{/?[^/]+$}{};
  for (prose($path)) {
    my ($line, $text) = @$_;
    $text =~ s/`[^`]*`//g;
    while ($text =~ /\]\(\s*<?([^)\s>]*)>?(?:\s+"[^"]*")?\s*\)/g) {
      my $target = $1;
      next if $target =~ /^[a-z][a-z0-9+.-]*:/i;
      ++$links;
      my ($to, $anchor) = $target =~ /^([^#]*)(?:#(.*))?$/;
      my @parts = split m{/}, $folder;
      for my $part ($to eq "" ? () : split m{/}, $to) {
        next if $part eq "." || $part eq "";
        if ($part ne "..") { push @parts, $part; }
        elsif (@parts) { pop @parts; }
        else { push @parts, ".."; }
      }
      my $file = $to eq "" ? $path : join "/", @parts;
      my $fault = !$there{$file} ? "no tracked file or folder $file"
                : defined $anchor && $file !~ /\.md$/ ? "an anchor in $file, which is no document"
                : defined $anchor && !anchors($file)->{$anchor} ? "no heading #$anchor in $file" : undef;
      next unless defined $fault;
      print "$path:$line: link to $target: $fault\n";
      ++$faults;
    }
  }
}
print "$links links, $faults faults\n";
exit($faults ? 5 : 0);
'
