#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Fetches and unpacks a source package of Debian, with lists of apt of its own: the system needs no deb-src line
# and is not changed. Fails if there is no mirror or the package cannot be had. Needs dpkg-dev.
# usage: .ci/apt-source.sh PACKAGE SUITE LISTS_DIR OUT_DIR      (LISTS_DIR is made and can be used again)
set -euo pipefail

package=$1 suite=$2 lists=$3 out=$4
keyring=/usr/share/keyrings/debian-archive-keyring.gpg
mirror=$("$(dirname "${BASH_SOURCE[0]}")/debian-mirror.sh")
[[ -n $mirror && -f $keyring ]] || exit 1
mkdir -p "$lists/lists/partial" "$lists/archives/partial"
echo "deb-src [signed-by=$keyring] $mirror $suite main" >"$lists/sources.list"
apt=(apt-get -q -y -o Dir::Etc::SourceList="$lists/sources.list" -o Dir::Etc::SourceParts=-
  -o Dir::State::Lists="$lists/lists" -o Dir::Cache="$lists" -o Dir::Cache::Archives="$lists/archives"
  -o APT::Sandbox::User=root -o APT::Update::Error-Mode=any -o Acquire::Retries=2)
"${apt[@]}" update
cd "$out"
"${apt[@]}" source "$package"
