# Lists of Debian's packages besides those of this machine, for apt-get; the machine's stay as they are. Read by the scripts beside it.
#
# own_lists FOLDER LINE...   fetches what each LINE says, as "deb-src unstable", and sets $own to the options that use them
#
# Needs: apt-get install debian-archive-keyring
own_lists() {
    keyring=/usr/share/keyrings/debian-archive-keyring.gpg
    [ -f "$keyring" ] || {
        echo "$keyring is missing: apt-get install debian-archive-keyring" >&2
        return 1
    }
    # The mirror that this machine uses anyway.
    mirror=$(apt-get indextargets --format '$(REPO_URI) $(ORIGIN)' 'Created-By: Packages' |
        awk '$2 == "Debian" && $1 !~ /security/ { print $1; exit }')
    [ -n "$mirror" ] || {
        echo "apt knows no mirror of Debian: apt-get update" >&2
        return 1
    }
    folder=$1
    shift
    mkdir -p "$folder/state/lists/partial" "$folder/cache/archives/partial"
    for line; do
        echo "${line% *} [signed-by=$keyring] $mirror ${line#* } main" >>"$folder/sources.list"
    done
    own="-o Dir::Etc::sourcelist=$folder/sources.list -o Dir::Etc::sourceparts=- -o Dir::State=$folder/state
        -o Dir::Cache=$folder/cache -o APT::Sandbox::User="
    apt-get $own update -qq
}
