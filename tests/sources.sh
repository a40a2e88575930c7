# sources.sh: what the text of the header and of the other sources has to be like. Read by hygiene.sh, whose check(), $dir,
# $compilers and lists of names it uses.

others=$(ls examples/*.c examples/*.h tests/*.c tests/*.h tests/*/*.c tests/*/*.h tests/*/*.cpp)
sources="mcsample.h $others"

# text FILE: its code, comments and strings left out, lines kept.
text() {
    awk '{
        line = $0
        out = ""
        while (line != "") {
            if (comment) {
                end = index(line, "*/")
                if (!end) { line = ""; break }
                line = substr(line, end + 2)
                comment = 0
            } else if (match(line, /\/\*|\/\/|"/)) {
                mark = substr(line, RSTART, RLENGTH)
                out = out substr(line, 1, RSTART - 1)
                line = substr(line, RSTART + RLENGTH)
                if (mark == "/*") comment = 1
                else if (mark == "//") line = ""
                else {
                    match(line, /^([^"\\]|\\.)*"/)
                    line = substr(line, RLENGTH + 1)
                    out = out "\"\""
                }
            } else { out = out line; line = "" }
        }
        print out
    }' "$1"
}

# interface: one line per prototype of part I: its name, and "bare" where no comment stands before it or names it. A comment counts
# for the prototype right below it, and for all down to the next comment that it names in full; a banner counts for these alone.
interface() {
    sed -n '/^\/\* PART I: /,/END OF PART I/p' mcsample.h | awk '
        /^\/\*/ { said = ""; banner = /^\/\* ====/; inside = 1 }
        inside { said = said $0 "\n"; if (/\*\//) { inside = 0; fresh = !banner } ; next }
        /^(MCS_FN|MCS_API) / {
            match($0, /mcs_[a-z0-9_]*\(/)
            name = substr($0, RSTART, RLENGTH - 1)
            named = said ~ ("(^|[^a-z0-9_])" name "([^a-z0-9_]|$)")
            print name, fresh || named || /\*\/$/ ? "said" : "bare"
            fresh = 0
        }
        /^$/ || /^[a-z}]/ { fresh = 0 }'
}

# --- part I declares every public function, once, and explains it; nothing else is public
interface >"$dir/interface"
cut -d' ' -f1 "$dir/interface" | sort >"$dir/declared"
grep -h '^mcs_' "$dir/functions.none" | sort -u >"$dir/public"
twice=$(uniq -d "$dir/declared")
[ -s "$dir/declared" ] && [ -z "$twice" ]
check $? "part I declares each of $(wc -l <"$dir/declared") functions once" $twice
lost=$(comm -13 "$dir/declared" "$dir/public")
check "$([ -z "$lost" ]; echo $?)" "part I declares every public function" $lost
lost=$(comm -23 "$dir/declared" "$dir/public")
check "$([ -z "$lost" ]; echo $?)" "every function that part I declares exists" $lost
bare=$(sed -n 's/ bare$//p' "$dir/interface")
check "$([ -z "$bare" ]; echo $?)" "every function of part I has a comment" $bare
text mcsample.h >"$dir/text.h"
begin=$(grep -n '^/\* PART I: ' mcsample.h | cut -d: -f1) end=$(grep -n 'END OF PART I' mcsample.h | cut -d: -f1)
elsewhere=$(sed "$begin,${end}d" "$dir/text.h" | grep -oE '^(MCS_FN|MCS_API) .*;$' | grep -oE '\bmcs_[a-z0-9_]+\(')
check "$([ -z "$elsewhere" ]; echo $?)" "prototypes of public functions stand in part I alone" $elsewhere
# mcs_f, mcs_i, mcs_u are what bodies call a lane: public types of packets, but names of the scalar pass only inside.
types=$(sed -n "$begin,${end}p" "$dir/text.h" | grep -oE '\bmcs_[a-z0-9_]+;' | tr -d ';' | sort -u)
lost=$(echo "$types" | comm -13 - "$dir/types.none" | grep '^mcs_' | grep -vxE 'mcs_[fiu]')
check "$([ -n "$types" ] && [ -z "$lost" ]; echo $?)" "part I has every public type" $lost
# Names of macros and enumerators that users see: the switches, and what part I has.
sed -n "1,${end}p" mcsample.h | grep -oE '\bMCS_[A-Z0-9_]+' | sort -u >"$dir/known"
lost=$({ sed "1,${end}d" "$dir/text.h" | grep -oE '\bMCS_[A-Z0-9_]+' | grep -vx MCS_; grep '^MCS_' "$dir/macros.header"; } |
    sort -u | comm -23 - "$dir/known")
check "$([ -z "$lost" ]; echo $?)" "no macro and no enumerator is public but the switches and those of part I" $lost
lost=$(sed -n 's/^mcs[0-9][0-9]*_/mcs_/p' "$dir/functions.MCS_PACKETS=16" "$dir/types.MCS_PACKETS=16" | sort -u |
    comm -23 - "$(sort -u "$dir/functions.none" "$dir/types.none" >"$dir/scalar" && echo "$dir/scalar")")
check "$([ -z "$lost" ]; echo $?)" "every name of packets has a scalar one" $lost
lost=$(grep -hE '^mcs[0-9]+_' "$dir/functions.none" "$dir/types.none" | head -n 3)
check "$([ -z "$lost" ]; echo $?)" "packets exist on request alone" $lost

# --- tools find what users look for
late=$(awk 'NR == FNR { wanted[$1]; next }
    { line = $0
      while (match(line, /mcs_[a-z0-9_]+/)) {
          name = substr(line, RSTART, RLENGTH)
          line = substr(line, RSTART + RLENGTH)
          if (name in wanted) { if ($0 !~ /^MCS_(FN|API) /) print name; delete wanted[name] }
      } }' "$dir/public" "$dir/text.h")
check "$([ -z "$late" ]; echo $?)" "grep shows the prototype of a function before its other uses in code" $late
if ctags --version 2>/dev/null | grep -q Universal; then
    lost=$(ctags -f - --kinds-C=+p mcsample.h 2>/dev/null | grep 'p	*typeref' | cut -f1 | sort -u | comm -13 - "$dir/public")
    check "$([ -z "$lost" ]; echo $?)" "ctags finds the prototype of every public function" $lost
else
    echo "SKIPPED: no Universal Ctags here"
fi

# --- [names]: both lists are the same and sorted
awk '/^#define mcsi?_[a-z0-9_]+ MCSI?_\(/ { print $2 }' mcsample.h >"$dir/defined"
awk '/^#include MCS_SELF/ { n = 0 } /^#undef mcsi?_/ { name[n++] = $2 } END { for (i = 0; i < n; i++) print name[i] }' mcsample.h >"$dir/undefined"
[ -s "$dir/defined" ] && sort -C "$dir/defined"
check $? "the names defined in [names] are sorted" "$(sort -c "$dir/defined" 2>&1)"
cmp -s "$dir/defined" "$dir/undefined"
check $? "names are undefined again as they were defined" $(diff "$dir/defined" "$dir/undefined" | sed -n 's/^[<>] //p' | head -n 5)

# --- a prototype that disagrees with its function does not compile
mkdir -p "$dir/disagree"
for line in 'MCS_FN float mcs_disk_pdf(' 'MCS_API float mcs_env_pdf('; do
    sed "0,/^$line/s/^$line/&int more, /" mcsample.h >"$dir/disagree/mcsample.h"
    for c in $compilers; do
        ! cmp -s mcsample.h "$dir/disagree/mcsample.h" &&
            ! $c -std=c99 -w -I"$dir/disagree" -fsyntax-only "$dir/include_none.c" 2>/dev/null
        check $? "$c: a prototype of ${line##* } ...) that disagrees does not compile"
    done
done

# --- warnings that few projects ask for. Those of -Weverything that are left, and why:
#   padded, switch-enum                      structs have no holes that matter; a default covers the other enumerators
#   float-equal                              comparisons with exact values are meant
#   bad-function-cast                        pointers are made free of const through uintptr_t
#   conditional-uninitialized                lanes of a vector are set one by one
#   nrvo                                     returns of two results: the functions are inline
#   old-style-cast, zero-as-null-pointer-constant    the text is C, too
#   unsafe-buffer-usage, unsafe-buffer-usage-in-libc-call    there are no arrays with bounds in C
#   c++98-compat and the like, long-long     the header is C99 and C++11
#   pre-c2x-compat, pre-c++*-compat          and clang says what is new there
allowed='padded|switch-enum|float-equal|bad-function-cast|conditional-uninitialized|nrvo|old-style-cast|zero-as-null-pointer-constant'
allowed="$allowed|unsafe-buffer-usage|unsafe-buffer-usage-in-libc-call|c\\+\\+98-compat.*|long-long|pre-c.*-compat"
for c in $compilers; do
    case $c in clang*) ;; *) continue ;; esac
    for way in HYGIENE $ways; do # the first one defines nothing that the header knows
        for std in c99 c++11; do
            case $std in c++*) language=c++ ;; *) language=c ;; esac
            $c -x $language -std=$std -Weverything -fno-caret-diagnostics -DMCS_WARNINGS -D"$way" -I. -fsyntax-only "$dir/include_none.c" 2>&1
        done
    done >"$dir/everything"
    kinds=$(sed -n 's/.*\[-W\([^]]*\)\]$/\1/p' "$dir/everything" | sort -u)
    new=$(echo "$kinds" | grep -vxE "$allowed")$(grep -m 1 error: "$dir/everything")
    check "$([ -n "$kinds" ] && [ -z "$new" ]; echo $?)" "$c -Weverything: nothing but" $kinds "${new:+; new:}" $new
    check "$(! grep -q 'Wcomma' "$dir/everything"; echo $?)" "$c -Wcomma: nothing"
done
cat >"$dir/after.c" <<'EOF'
#include "mcsample.h"
int after(void);
int after(void) {
    (void)0;
    int i = 0;
    return i;
}
EOF
for c in $compilers; do
    for way in HYGIENE MCS_WARNINGS; do # the first one is nothing that the header knows
        $c -std=c99 -Wdeclaration-after-statement -D$way -I. -fsyntax-only "$dir/after.c" 2>"$dir/after.log"
        [ "$(grep -c 'warning:' "$dir/after.log")" = 1 ] && grep -q 'after.c' "$dir/after.log"
        check $? "$c -Wdeclaration-after-statement, $way: silent in the header, not behind it" "$(grep -m 1 mcsample.h "$dir/after.log")"
    done
done

# --- the look of sources
# The header in pieces, one a banner, without empty lines at their ends: clang-format reads a file once for each way through all of its
# #if, fifty times as long for the whole.
if clang-format --version 2>/dev/null | grep -q 'version 14\.'; then
    mkdir -p "$dir/pieces"
    cp .clang-format "$dir/pieces"
    awk -v to="$dir/pieces/line" 'function begin() { piece = sprintf("%s%05d.h", to, NR) }
        NR == 1 { begin() }
        /^\/\* (====|----) / { if (piece) close(piece); begin(); empty = 0 }
        /^$/ { empty++; next }
        { for (; empty; empty--) print "" >piece; print >piece }' mcsample.h
    # shellcheck disable=SC2086
    other=$(clang-format --dry-run --Werror $others "$dir"/pieces/line*.h 2>&1 | sed -n 's/^\([^:]*\):[0-9]*:.*/\1/p' | sort -u)
    check "$([ -z "$other" ]; echo $?)" "clang-format leaves all sources as they are" $other
    check "$(cat -s mcsample.h | cmp -s - mcsample.h; echo $?)" "no two empty lines of the header stand in a row"
else
    echo "SKIPPED: no clang-format 14 here: nothing says whether sources are formatted"
fi
long=$(awk 'length > 120 { print FILENAME ":" FNR }' mcsample.h)
check "$([ -z "$long" ]; echo $?)" "no line of the header has more than 120 characters" $(echo "$long" | head -n 5)
# shellcheck disable=SC2086
long=$(awk 'length > 132 { print FILENAME ":" FNR }' $others)
check "$([ -z "$long" ]; echo $?)" "no line of other sources has more than 132" $long

# bodies FILE: name, lines and parameters of each function that FILE defines, macros left out.
bodies() {
    text "$1" | awk '
        /\\$/ { macro = 1; next }
        macro { macro = 0; next }
        /^#/ { next }
        !open && /^[A-Za-z_].*\(/ && !/^(typedef|struct|enum|union)/ && !/;$/ { head = ""; begin = NR; open = 1; up = 0 }
        open == 1 { head = head " " $0; if (/;$/ && !/\{/) { open = 0; next } }
        open == 1 && /\{/ { open = 2 }
        open == 2 {
            line = $0
            up += gsub(/\{/, "", line)
            up -= gsub(/\}/, "", line)
            if (up <= 0) {
                open = 0
                sub(/\{.*/, "", head)
                if (!match(head, /[A-Za-z_][A-Za-z0-9_]*\([^()]*(\([^()]*\)[^()]*)*\) *$/)) next
                call = substr(head, RSTART)
                name = call
                sub(/\(.*/, "", name)
                sub(/^[^(]*\(/, "", call)
                while (gsub(/\([^()]*\)/, "", call)) {}
                print name, NR - begin + 1, call ~ /void\)/ ? 0 : gsub(/,/, "", call) + 1
            }
        }'
}
# Functions of the header beyond 40 lines, as an expression, and why they are. Each has to be as long as that, or it leaves the list.
may_be_long=
# Functions with more than 6 parameters. A window is a rectangle, which is four numbers. With structs for what mcsi_ggx_draw_d takes,
# visible normals take 2 % longer.
may_take_many='mcs_env_window_build|mcsi_ggx_draw_d'
# How many functions of other sources still have more: the number goes down with each that loses some, and never up.
many_yet=21
for f in $sources; do bodies "$f" | sed "s|^|$f |"; done >"$dir/bodies"
long=$(awk '$3 > 60 { print $1 ":" $2 "(" $3 ")" }' "$dir/bodies")
check "$([ -s "$dir/bodies" ] && [ -z "$long" ]; echo $?)" "none of $(wc -l <"$dir/bodies") functions has more than 60 lines" $long
long=$(awk '$1 == "mcsample.h" && $3 > 40 { print $2 }' "$dir/bodies" | sort -u)
extra=$(echo "$long" | grep -vxE "$may_be_long")
check "$([ -z "$extra" ]; echo $?)" "functions of the header have at most 40 lines, but for those with a reason" $extra
stale=$(echo "$may_be_long" | tr '|' '\n' | while read -r n; do echo "$long" | grep -qx "$n" || echo "$n"; done)
check "$([ -z "$stale" ]; echo $?)" "those with a reason have more" $stale
many=$(awk '$1 == "mcsample.h" && $4 > 6 && $2 !~ /_n$|_loop$|^mcsi_batch_/ { print $2 }' "$dir/bodies" | sort -u)
extra=$(echo "$many" | grep -vxE "$may_take_many")
check "$([ -z "$extra" ]; echo $?)" "functions of the header have at most 6 parameters, but array forms and those with a reason" $extra
stale=$(echo "$may_take_many" | tr '|' '\n' | while read -r n; do echo "$many" | grep -qx "$n" || echo "$n"; done)
check "$([ -z "$stale" ]; echo $?)" "those with a reason have more" $stale
many=$(awk '$1 != "mcsample.h" && $4 > 6 { print $1 ":" $2 "(" $4 ")" }' "$dir/bodies" | sort -u)
found=$(echo "$many" | grep -c .)
check "$([ "$found" = $many_yet ]; echo $?)" "of the other sources $many_yet functions have more than 6 parameters" \
    $([ "$found" = $many_yet ] || echo "$found: $many")
