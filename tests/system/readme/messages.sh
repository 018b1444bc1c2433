# SPDX-License-Identifier: Apache-2.0
# What the reader of the map of the messages has: the four packages, and a Debian to install them on. See run.py.
blocks=2

# The packages' files on this computer's, for this shell alone: what apt would bring beside them is here already.
apt() {
  [ "$1" = install ] || return 1
  local package
  for package in "${@:2}"; do
    case $package in
      ./*.deb) dpkg-deb -x "$package" "$work/root" ;;
      *) dpkg-query -W "$package" ;;
    esac
  done
  mkdir "$work/behind"
  if ! mount -t overlay overlay -o "lowerdir=$work/root/usr:/usr" /usr; then
    echo "no overlay of file systems for this user, to lay the packages over /usr; run as root"
    exit 77
  fi
}

before_1() {
  work=$(mktemp -d)
  cleanup() { rm -rf "$work"; }
  trap cleanup EXIT
  cp -r /etc "$work/etc" 2>/dev/null || true
  mkdir -p "$work/packages" "$work/home" "$work/etc"
  mount --bind "$work/etc" /etc
  mount --bind "$work/home" /root
  cpack --config "$build/CPackConfig.cmake" -B "$work/packages" >"$work/log" 2>&1
  cd "$work/packages"
  # What stands in the block for everybody is set up by who runs this.
  ip route del 224.0.0.0/4
  ip link set lo multicast off
}
after_1() {
  kill %1
  wait
  [ "$(command -v ifog)" = /usr/bin/ifog ]
}

# The window of lcm-spy wants a screen; which types it knows it says before.
before_2() {
  if ! command -v java >/dev/null || [ ! -e /usr/share/java/jchart2d.jar ] || ! ls /usr/share/java/ifogd-msgs-*.jar >/dev/null; then
    echo "the Java types were not built, or lcm-spy is missing: tools/install-packages test brings them, then configure again"
    exit 77
  fi
  unset DISPLAY
  java() { timeout 60 "$(type -P java)" "$@" >"$work/spy" 2>&1 || true; }
}
after_2() { grep -q 'Found 5 LCM types' "$work/spy"; }
