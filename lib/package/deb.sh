#!/bin/sh
# Debian packages of the archive that `make dist` leaves in BUILD; they end in BUILD/deb. Their
# maintainer is whom DEBFULLNAME and DEBEMAIL tell, as Debian's own tools have it.
#   deb.sh BUILD VERSION 'PACKAGES THAT IT IS BUILT WITH'
set -eu
here=$(cd "$(dirname "$0")" && pwd)
name=geotex-$2
date=$(git -C "$here" log -1 --format=%cD)
rm -rf "$1/deb"
mkdir "$1/deb"
tar -xzf "$1/$name.tar.gz" -C "$1/deb"
cp -r "$here/debian" "$1/deb/$name/debian"
cd "$1/deb/$name/debian"
author="${DEBFULLNAME:-The geotex authors} <${DEBEMAIL:-geotex@localhost}>"
sed "s/@MAINTAINER@/$author/; s/@BUILD_DEPENDS@/$(echo $3 | sed 's/ /, /g')/" control.in >control
rm control.in
printf 'geotex (%s) unstable; urgency=medium\n\n  * CHANGELOG.md tells.\n\n -- %s  %s\n' \
    "$2" "$author" "$date" >changelog
cd ..
dpkg-buildpackage -us -uc -b
