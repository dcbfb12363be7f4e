#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Checks the language of comments, documents and string literals against CONTRIBUTING.md:
# - no sentence begins with Of, What, Whatever, Where, Wherever or Nor;
# - no verb of persons (ask, tell, owe, pay, know, believe, bear, give way, foretell) describes data.
# Usage: tools/check_words.sh [--root FOLDER] [PATH...]
# Without PATH it compares every finding in the tracked files with the accepted ones in check_words.accepted, one a line as
# "path: text of the line". It fails on a finding that is not accepted, and on an accepted line that is no longer found.
# README files, string literals and public headers cannot be accepted. With PATH it lists the findings there.
# Exit codes: 0 no fault, 1 usage, 5 faults, else the failure of git or perl.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
if [ "${1:-}" = --root ]; then
  [ $# -ge 2 ] || { echo "check_words.sh: --root needs a folder" >&2; exit 1; }
  root=$2
  shift 2
fi
cd "$root"
accepted=tools/check_words.accepted
[ $# -eq 0 ] || accepted=
git ls-files -z -- "$@" | ACCEPTED=$accepted perl -e '
use strict;
use warnings;
my $opener = qr/(?:Of|What|Whatever|Where|Wherever|Nor)(?= [a-z`(])/;
my $opens = qr/(?:^|[.:;!?|] |^[-*>#]+ |^\d+\. )$opener/;
my $verb = qr/\b(?:ask(?:s|ed|ing)?|tells?|told|telling|owe[sd]?|owing|pays?|paid|paying|knows?|knew|knowing
                |believe[sd]?|believing|bears?|bore|borne|foretell(?:s|ing)?|foretold|(?:give|gives|gave|giving)\ way)\b/x;
my $person = qr/\b(?:user|users|reader|readers|operator|surgeon|person|people|you|who|we|nobody|author)\s+(?:\w+\s+)?$/i;

# The pieces of a file that people read, as [line number, kind, text].
sub pieces {
  my ($path, $text) = @_;
  my @found;
  my $line = 1;
  if ($path =~ /\.(?:hpp|cpp|h)$/) {
    while ($text =~ m{\G(?:
        (?<skip>[^"\x27/\nR]+|\w\x27|R(?!")|\w+(?=\x27\w))
      | R"(?<mark>\w*)\((?<raw>.*?)\)\k<mark>"
      | "(?<string>(?:\\.|[^"\\\n])*)"
      | \x27(?:\\.|[^\x27\\\n])+\x27
      | //+<?(?<comment>[^\n]*)
      | /\*(?<block>.*?)\*/
      | . )}gsx) {
      my $all = $&;
      if (defined $+{string}) { push @found, [$line, "string", $+{string}]; }
      elsif (defined $+{comment}) { push @found, [$line, "comment", $+{comment}]; }
      elsif (defined(my $many = $+{raw} // $+{block})) {
        my $at = $line;
        push @found, map { s/^\s*\*//; [$at++, defined $+{raw} ? "string" : "comment", $_] } split /\n/, $many, -1;
      }
      $line += ($all =~ tr/\n//);
    }
  } elsif ($path =~ /\.md$/) {
    my $code = 0;
    for (split /\n/, $text, -1) {
      if (/^\s*```/) { $code = !$code; }
      elsif (!$code && !/^    \S/) {
        my $prose = $_;
        $prose =~ s/`[^`]*`/`code`/g;
        push @found, [$line, "document", $prose];
      }
      ++$line;
    }
  } else {
    for (split /\n/, $text, -1) {
      my $code = $_;
      if ($code =~ s/(?:^|\s)#+ (.*)$//) { push @found, [$line, "comment", $1]; }
      while ($code =~ /"((?:\\.|[^"\\])*)"/g) { push @found, [$line, "string", $1]; }
      ++$line;
    }
  }
  return @found;
}

my (%found, @order, %strict);
for my $path (split /\0/, do { local $/; <STDIN> // "" }) {
  next unless $path =~ /(?:\.(?:hpp|cpp|h|md|sh|cmake|py)|CMakeLists\.txt)$/ && -f $path;
  next if $path =~ m{^tools/check_words\.sh$|^tests/tools/check_words_test\.cmake$};  # they quote the words
  open my $file, "<", $path or die "$path: $!";
  my $text = do { local $/; <$file> };
  my @lines = split /\n/, $text, -1;
  for (pieces($path, $text)) {
    my ($line, $kind, $words) = @$_;
    $words =~ s/^\s+//;
    $words =~ s/\\n/ /g;
    my $fault;
    if ($words =~ /$opens/ || ($kind eq "string" && $words =~ /^(?:what|whatever|nor) [a-z]/)) { $fault = "opening"; }
    while (!$fault && $words =~ /$verb/g) {
      $fault = "verb \"$&\"" unless substr($words, 0, $-[0]) =~ $person;
    }
    next unless $fault;
    (my $shown = $lines[$line - 1]) =~ s/^\s+//;
    my $place = "$path: $shown";
    next if $found{$place};
    $found{$place} = "$path:$line: $fault: $shown";
    $strict{$place} = 1 if $kind eq "string" || ($path =~ m{/include/|(?:^|/)README\.md$});
    push @order, $place;
  }
}
my %accepted;
if ($ENV{ACCEPTED}) {
  if (open my $list, "<", $ENV{ACCEPTED}) {
    while (<$list>) { chomp; $accepted{$_} = 1 if /\S/ && !/^#/; }
  }
}
my $faults = 0;
for (@order) {
  next if $accepted{$_} && !$strict{$_};
  print $found{$_}, $accepted{$_} ? " (cannot be accepted)" : "", "\n";
  ++$faults;
}
for (sort keys %accepted) {
  next if $found{$_};
  print "accepted, but no longer there: $_\n";
  ++$faults;
}
print "$faults faults: reword them; CONTRIBUTING.md, Language, has the rules\n" if $faults;
exit($faults ? 5 : 0);
'
