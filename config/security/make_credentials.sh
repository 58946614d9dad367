#!/usr/bin/env bash
# Makes credentials for DDS Security with openssl:  make_credentials.sh DIR [NAME ROLE]
# DIR/authority is made the first time: who holds it decides who takes part. Then DIR/NAME for each participant: by
# default one for every role of roles.txt, named like it. README.md beside this script says the rest.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
umask 077

(($# == 1 || $# == 3)) || { echo "usage: $0 DIR [NAME ROLE]" >&2; exit 2; }
dir=$1
days=${FJR_SECURITY_DAYS:-3650}
valid_from=$(date -u -d '1 day ago' +%Y-%m-%dT%H:%M:%S)
valid_to=$(date -u -d "$days days" +%Y-%m-%dT%H:%M:%S)
mapfile -t roles < <(awk '!/^#/ && NF {print $1}' "$here/roles.txt" | sort -u)

# key FILE; the curve is one that DDS Security names
key() { openssl ecparam -name prime256v1 -genkey -noout | openssl pkcs8 -topk8 -nocrypt -out "$1"; }

# authority NAME
authority() {
  key "$dir/authority/$1.key.pem"
  openssl req -x509 -new -sha256 -days "$days" -key "$dir/authority/$1.key.pem" \
    -subj "/O=fjr/CN=$1" -out "$dir/authority/$1.cert.pem"
}

# sign IN OUT: as the permissions authority, S/MIME
sign() {
  openssl smime -sign -text -in "$1" -out "$2" \
    -signer "$dir/authority/permissions_ca.cert.pem" -inkey "$dir/authority/permissions_ca.key.pem"
}

# rules ROLE: its lines of roles.txt as XML
rules() {
  echo '<allow_rule><domains><id_range><min>0</min><max>230</max></id_range></domains>'
  while read -r role direction list; do
    [[ $role == "$1" ]] || continue
    read -ra topics <<< "$list"
    echo "<$direction><topics>"
    printf '<topic>%s</topic>\n' "${topics[@]}"
    echo "</topics><partitions><partition></partition><partition>*</partition></partitions></$direction>"
  done < <(grep -v '^#' "$here/roles.txt")
  echo '</allow_rule>'
}

# permissions NAME ROLE
permissions() {
  cat <<XML
<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
     xsi:noNamespaceSchemaLocation="https://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_permissions.xsd">
<permissions><grant name="$2">
<subject_name>O=fjr,OU=$2,CN=$1</subject_name>
<validity><not_before>$valid_from</not_before><not_after>$valid_to</not_after></validity>
$(rules "$2")
<default>DENY</default>
</grant></permissions></dds>
XML
}

# participant NAME ROLE
participant() {
  [[ " ${roles[*]} " == *" $2 "* ]] || { echo "$0: role $2 is not one of ${roles[*]}" >&2; exit 2; }
  [[ $1 =~ ^[A-Za-z0-9_.-]+$ && $1 != authority ]] || { echo "$0: $1 is no name for a participant" >&2; exit 2; }
  [[ ! -e $dir/$1 ]] || { echo "$0: $dir/$1 exists already" >&2; exit 2; }
  local made="$dir/.$1.new"
  rm -rf "$made"
  mkdir "$made"
  key "$made/key.pem"
  openssl req -new -sha256 -key "$made/key.pem" -subj "/O=fjr/OU=$2/CN=$1" |
    openssl x509 -req -sha256 -days "$days" -CA "$dir/authority/identity_ca.cert.pem" \
      -CAkey "$dir/authority/identity_ca.key.pem" -set_serial "0x$(openssl rand -hex 16)" -out "$made/cert.pem" 2>/dev/null
  permissions "$1" "$2" > "$made/permissions.xml"
  sign "$made/permissions.xml" "$made/permissions.p7s"
  cp "$dir/authority/"{identity_ca.cert.pem,permissions_ca.cert.pem,governance.p7s} "$made"
  mv "$made" "$dir/$1"
  echo "$dir/$1: $2"
}

if [[ ! -e $dir/authority ]]; then
  mkdir -p "$dir/authority"
  authority identity_ca
  authority permissions_ca
  sign "$here/governance.xml" "$dir/authority/governance.p7s"
fi
if (($# == 3)); then
  participant "$2" "$3"
else
  for role in "${roles[@]}"; do participant "$role" "$role"; done
fi
