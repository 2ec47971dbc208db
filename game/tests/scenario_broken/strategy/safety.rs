//! Mistakes in strategies: safety.

use super::{Broken, assert_broken};

const SAFETY: &[Broken] = &[
    (
        "no safety",
        r#"[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
"#,
        &[
            "1:1: mode active has no avoid_collision on guard, expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
            "1:1: mode active has no op_region on guard, expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
        ],
    ),
    (
        "safety in some modes only",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "tagged"
[[mode]]
name = "b"
[behaviour.keep_clear]
in = ["a"]
"#,
        &[
            "9:1: mode b has no avoid_collision on guard, expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
        ],
    ),
    (
        "safety in all parts but one",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "tagged"
[[mode]]
name = "b"
in = "a"
when = "own_side"
[[mode]]
name = "c"
in = "a"
[[mode]]
name = "d"
[behaviour.stay_in]
in = ["b", "d"]
"#,
        &[
            "13:1: mode a:c has no op_region on guard, expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
        ],
    ),
    (
        "safety with a condition",
        r#"base = "s.toml"
[behaviour.keep_clear]
when = "!tagged"
"#,
        &[
            "1:1: mode active has no avoid_collision on guard (keep_clear is none: it has a condition), expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
        ],
    ),
    (
        "safety for some contacts",
        r#"base = "s.toml"
[behaviour.keep_clear]
contacts = "enemies"
"#,
        &[
            "1:1: mode active has no avoid_collision on guard (keep_clear is none: it is not for all contacts), expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
        ],
    ),
    (
        "safety without weight",
        r#"base = "s.toml"
[behaviour.keep_clear]
weight = 0
[behaviour.stay_in]
weight = "100 + score"
"#,
        &[
            "1:1: mode active has no avoid_collision on guard (keep_clear is none: weight is 0), expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
            "1:1: mode active has no op_region on guard (stay_in is none: weight is no number), expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
        ],
    ),
    (
        "safety for a while",
        r#"base = "s.toml"
[behaviour.stay_in]
duration_s = 30
"#,
        &[
            "1:1: mode active has no op_region on guard (stay_in is none: it has a duration_s), expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
        ],
    ),
    (
        "no reason",
        r#"unsafe_i_know = true
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
"#,
        &["1:17: unsafe_because is missing, expected the reason"],
    ),
    (
        "an empty reason",
        r#"unsafe_i_know = true
unsafe_because = " "
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
"#,
        &["2:18: unsafe_because is empty, expected the reason"],
    ),
    (
        "a reason alone",
        r#"unsafe_because = "a test"
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
"#,
        &["1:18: unsafe_because is given without unsafe_i_know = true, expected both or neither"],
    ),
    (
        "a reason that says no",
        r#"unsafe_i_know = false
unsafe_because = "a test"
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
"#,
        &["2:18: unsafe_because is given without unsafe_i_know = true, expected both or neither"],
    ),
    (
        "a reason that is not needed",
        r#"base = "s.toml"
unsafe_i_know = true
unsafe_because = "a test"
"#,
        &["3:18: unsafe_because is not needed: every mode has op_region and avoid_collision, expected none"],
    ),
    (
        "a field much larger than the field",
        r#"base = "s.toml"
[behaviour.stay_in]
margin_m = -1000
"#,
        &[
            r#"1:1: mode active has no op_region on guard (stay_in is none: margin_m is -1000, less than 0), expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because"#,
        ],
    ),
    (
        "a field that is left for good after a while",
        r#"base = "s.toml"
[behaviour.stay_in]
margin_m = "time_s > 10 ? -1000 : 0"
"#,
        &[
            r#"1:1: mode active has no op_region on guard (stay_in is none: margin_m is no number), expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because"#,
        ],
    ),
    (
        "no room to turn back",
        r#"base = "s.toml"
[behaviour.stay_in]
save_m = 0
"#,
        &[
            r#"1:1: mode active has no op_region on guard (stay_in is none: save_m is 0, less than 1), expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because"#,
        ],
    ),
    (
        "no foresight",
        r#"base = "s.toml"
[behaviour.stay_in]
lookahead_s = 0.5
"#,
        &[
            r#"1:1: mode active has no op_region on guard (stay_in is none: lookahead_s is 0.5, less than 1), expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because"#,
        ],
    ),
    (
        "out for long before it counts",
        r#"base = "s.toml"
[behaviour.stay_in]
exit_s = 600
"#,
        &[
            r#"1:1: mode active has no op_region on guard (stay_in is none: exit_s is 600, more than 10), expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because"#,
        ],
    ),
    (
        "no way back",
        r#"base = "s.toml"
[behaviour.stay_in]
recovery_speed_m_s = 0
"#,
        &[
            r#"1:1: mode active has no op_region on guard (stay_in is none: recovery_speed_m_s is 0, less than 0.1), expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because"#,
        ],
    ),
    (
        "no boat is near enough",
        r#"base = "s.toml"
[behaviour.keep_clear]
inner_m = 0
outer_m = "has_flag ? 0 : 30"
"#,
        &[
            r#"1:1: mode active has no avoid_collision on guard (keep_clear is none: outer_m is no number), expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because"#,
        ],
    ),
    (
        "no pass is too near",
        r#"base = "s.toml"
[behaviour.keep_clear]
cpa_min_m = 0
cpa_max_m = 0
"#,
        &[
            r#"1:1: mode active has no avoid_collision on guard (keep_clear is none: cpa_max_m is 0, less than 3), expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because"#,
        ],
    ),
    (
        "no time to come near",
        r#"base = "s.toml"
[behaviour.keep_clear]
time_on_leg_s = 0.1
"#,
        &[
            r#"1:1: mode active has no avoid_collision on guard (keep_clear is none: time_on_leg_s is 0.1, less than 1), expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because"#,
        ],
    ),
    (
        "a goal above safety",
        r#"base = "s.toml"
[behaviour.go]
kind = "waypoint"
points = ["CF"]
weight = 301
"#,
        &[r#"5:10: weight is 301 in mode active, expected at most 300, which op_region or avoid_collision has there"#],
    ),
    (
        "safety that is worth hardly anything",
        r#"base = "s.toml"
[behaviour.stay_in]
weight = 1e-9
[behaviour.go]
kind = "waypoint"
points = ["CF"]
"#,
        &[
            r#"4:12: weight is 100 in mode active, expected at most 0.000000001, which op_region or avoid_collision has there"#,
        ],
    ),
    (
        "a reason of another file",
        r#"base = "unsafe.toml"
[behaviour.go]
kind = "waypoint"
points = ["CF"]
"#,
        &[
            r#"1:1: mode active has no avoid_collision on guard, expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because"#,
            r#"1:1: mode active has no op_region on guard, expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because"#,
        ],
    ),
    (
        "numbers that are none",
        r#"base = "s.toml"
[behaviour.go]
kind = "waypoint"
points = ["CF"]
speed_m_s = nan
weight = inf
"#,
        &[r#"5:13: speed_m_s is nan, expected 0 to 60"#, r#"6:10: weight is inf, expected 0 to 1000"#],
    ),
    (
        "more than a helm hears",
        r#"base = "s.toml"
[behaviour.a00]
kind = "avoid_collision"
[behaviour.a01]
kind = "avoid_collision"
[behaviour.a02]
kind = "avoid_collision"
[behaviour.a03]
kind = "avoid_collision"
[behaviour.a04]
kind = "avoid_collision"
[behaviour.a05]
kind = "avoid_collision"
[behaviour.a06]
kind = "avoid_collision"
[behaviour.a07]
kind = "avoid_collision"
[behaviour.a08]
kind = "avoid_collision"
[behaviour.a09]
kind = "avoid_collision"
[behaviour.a10]
kind = "avoid_collision"
[behaviour.a11]
kind = "avoid_collision"
[behaviour.a12]
kind = "avoid_collision"
[behaviour.a13]
kind = "avoid_collision"
[behaviour.a14]
kind = "avoid_collision"
[behaviour.a15]
kind = "avoid_collision"
"#,
        &[
            r#"1:1: mode active could ask for 273 functions at once, expected at most 256: 16 for each avoid_collision and avoid_obstacle, 2 for each cut_range, 1 for each other behaviour"#,
        ],
    ),
    (
        "more than mates hear",
        r#"base = "s.toml"
[variables]
v0 = { initial = 0, shared = true }
v1 = { initial = 0, shared = true }
v2 = { initial = 0, shared = true }
v3 = { initial = 0, shared = true }
v4 = { initial = 0, shared = true }
v5 = { initial = 0, shared = true }
v6 = { initial = 0, shared = true }
v7 = { initial = 0, shared = true }
v8 = { initial = 0, shared = true }
v9 = { initial = 0, shared = true }
v10 = { initial = 0, shared = true }
v11 = { initial = 0, shared = true }
v12 = { initial = 0, shared = true }
v13 = { initial = 0, shared = true }
v14 = { initial = 0, shared = true }
v15 = { initial = 0, shared = true }
v16 = { initial = 0, shared = true }
v17 = { initial = 0, shared = true }
v18 = { initial = 0, shared = true }
v19 = { initial = 0, shared = true }
v20 = { initial = 0, shared = true }
v21 = { initial = 0, shared = true }
v22 = { initial = 0, shared = true }
v23 = { initial = 0, shared = true }
v24 = { initial = 0, shared = true }
v25 = { initial = 0, shared = true }
v26 = { initial = 0, shared = true }
v27 = { initial = 0, shared = true }
v28 = { initial = 0, shared = true }
v29 = { initial = 0, shared = true }
v30 = { initial = 0, shared = true }
v31 = { initial = 0, shared = true }
v32 = { initial = 0, shared = true }
v33 = { initial = 0, shared = true }
v34 = { initial = 0, shared = true }
v35 = { initial = 0, shared = true }
v36 = { initial = 0, shared = true }
v37 = { initial = 0, shared = true }
v38 = { initial = 0, shared = true }
v39 = { initial = 0, shared = true }
v40 = { initial = 0, shared = true }
v41 = { initial = 0, shared = true }
v42 = { initial = 0, shared = true }
v43 = { initial = 0, shared = true }
v44 = { initial = 0, shared = true }
v45 = { initial = 0, shared = true }
v46 = { initial = 0, shared = true }
v47 = { initial = 0, shared = true }
v48 = { initial = 0, shared = true }
v49 = { initial = 0, shared = true }
v50 = { initial = 0, shared = true }
v51 = { initial = 0, shared = true }
v52 = { initial = 0, shared = true }
v53 = { initial = 0, shared = true }
v54 = { initial = 0, shared = true }
v55 = { initial = 0, shared = true }
v56 = { initial = 0, shared = true }
v57 = { initial = 0, shared = true }
v58 = { initial = 0, shared = true }
v59 = { initial = 0, shared = true }
v60 = { initial = 0, shared = true }
v61 = { initial = 0, shared = true }
v62 = { initial = 0, shared = true }
v63 = { initial = 0, shared = true }
v64 = { initial = 0, shared = true }
v65 = { initial = 0, shared = true }
v66 = { initial = 0, shared = true }
v67 = { initial = 0, shared = true }
v68 = { initial = 0, shared = true }
v69 = { initial = 0, shared = true }
v70 = { initial = 0, shared = true }
v71 = { initial = 0, shared = true }
v72 = { initial = 0, shared = true }
v73 = { initial = 0, shared = true }
v74 = { initial = 0, shared = true }
v75 = { initial = 0, shared = true }
v76 = { initial = 0, shared = true }
v77 = { initial = 0, shared = true }
v78 = { initial = 0, shared = true }
v79 = { initial = 0, shared = true }
v80 = { initial = 0, shared = true }
v81 = { initial = 0, shared = true }
v82 = { initial = 0, shared = true }
v83 = { initial = 0, shared = true }
v84 = { initial = 0, shared = true }
v85 = { initial = 0, shared = true }
v86 = { initial = 0, shared = true }
v87 = { initial = 0, shared = true }
v88 = { initial = 0, shared = true }
v89 = { initial = 0, shared = true }
v90 = { initial = 0, shared = true }
v91 = { initial = 0, shared = true }
v92 = { initial = 0, shared = true }
v93 = { initial = 0, shared = true }
v94 = { initial = 0, shared = true }
v95 = { initial = 0, shared = true }
v96 = { initial = 0, shared = true }
v97 = { initial = 0, shared = true }
v98 = { initial = 0, shared = true }
v99 = { initial = 0, shared = true }
v100 = { initial = 0, shared = true }
v101 = { initial = 0, shared = true }
v102 = { initial = 0, shared = true }
v103 = { initial = 0, shared = true }
v104 = { initial = 0, shared = true }
v105 = { initial = 0, shared = true }
v106 = { initial = 0, shared = true }
v107 = { initial = 0, shared = true }
v108 = { initial = 0, shared = true }
v109 = { initial = 0, shared = true }
v110 = { initial = 0, shared = true }
v111 = { initial = 0, shared = true }
v112 = { initial = 0, shared = true }
v113 = { initial = 0, shared = true }
v114 = { initial = 0, shared = true }
v115 = { initial = 0, shared = true }
v116 = { initial = 0, shared = true }
v117 = { initial = 0, shared = true }
v118 = { initial = 0, shared = true }
v119 = { initial = 0, shared = true }
v120 = { initial = 0, shared = true }
v121 = { initial = 0, shared = true }
v122 = { initial = 0, shared = true }
v123 = { initial = 0, shared = true }
v124 = { initial = 0, shared = true }
v125 = { initial = 0, shared = true }
v126 = { initial = 0, shared = true }
v127 = { initial = 0, shared = true }
v128 = { initial = 0, shared = true }
v129 = { initial = 0, shared = true }
v130 = { initial = 0, shared = true }
v131 = { initial = 0, shared = true }
v132 = { initial = 0, shared = true }
v133 = { initial = 0, shared = true }
v134 = { initial = 0, shared = true }
v135 = { initial = 0, shared = true }
v136 = { initial = 0, shared = true }
v137 = { initial = 0, shared = true }
v138 = { initial = 0, shared = true }
v139 = { initial = 0, shared = true }
v140 = { initial = 0, shared = true }
v141 = { initial = 0, shared = true }
v142 = { initial = 0, shared = true }
v143 = { initial = 0, shared = true }
v144 = { initial = 0, shared = true }
v145 = { initial = 0, shared = true }
v146 = { initial = 0, shared = true }
v147 = { initial = 0, shared = true }
v148 = { initial = 0, shared = true }
v149 = { initial = 0, shared = true }
v150 = { initial = 0, shared = true }
v151 = { initial = 0, shared = true }
v152 = { initial = 0, shared = true }
v153 = { initial = 0, shared = true }
v154 = { initial = 0, shared = true }
v155 = { initial = 0, shared = true }
v156 = { initial = 0, shared = true }
v157 = { initial = 0, shared = true }
v158 = { initial = 0, shared = true }
v159 = { initial = 0, shared = true }
v160 = { initial = 0, shared = true }
v161 = { initial = 0, shared = true }
v162 = { initial = 0, shared = true }
v163 = { initial = 0, shared = true }
v164 = { initial = 0, shared = true }
v165 = { initial = 0, shared = true }
v166 = { initial = 0, shared = true }
v167 = { initial = 0, shared = true }
v168 = { initial = 0, shared = true }
v169 = { initial = 0, shared = true }
v170 = { initial = 0, shared = true }
v171 = { initial = 0, shared = true }
v172 = { initial = 0, shared = true }
v173 = { initial = 0, shared = true }
v174 = { initial = 0, shared = true }
v175 = { initial = 0, shared = true }
v176 = { initial = 0, shared = true }
v177 = { initial = 0, shared = true }
v178 = { initial = 0, shared = true }
v179 = { initial = 0, shared = true }
v180 = { initial = 0, shared = true }
v181 = { initial = 0, shared = true }
v182 = { initial = 0, shared = true }
v183 = { initial = 0, shared = true }
v184 = { initial = 0, shared = true }
v185 = { initial = 0, shared = true }
v186 = { initial = 0, shared = true }
v187 = { initial = 0, shared = true }
v188 = { initial = 0, shared = true }
v189 = { initial = 0, shared = true }
v190 = { initial = 0, shared = true }
v191 = { initial = 0, shared = true }
v192 = { initial = 0, shared = true }
v193 = { initial = 0, shared = true }
v194 = { initial = 0, shared = true }
v195 = { initial = 0, shared = true }
v196 = { initial = 0, shared = true }
v197 = { initial = 0, shared = true }
v198 = { initial = 0, shared = true }
v199 = { initial = 0, shared = true }
v200 = { initial = 0, shared = true }
v201 = { initial = 0, shared = true }
v202 = { initial = 0, shared = true }
v203 = { initial = 0, shared = true }
v204 = { initial = 0, shared = true }
v205 = { initial = 0, shared = true }
v206 = { initial = 0, shared = true }
v207 = { initial = 0, shared = true }
v208 = { initial = 0, shared = true }
v209 = { initial = 0, shared = true }
v210 = { initial = 0, shared = true }
v211 = { initial = 0, shared = true }
v212 = { initial = 0, shared = true }
v213 = { initial = 0, shared = true }
v214 = { initial = 0, shared = true }
v215 = { initial = 0, shared = true }
v216 = { initial = 0, shared = true }
v217 = { initial = 0, shared = true }
v218 = { initial = 0, shared = true }
v219 = { initial = 0, shared = true }
v220 = { initial = 0, shared = true }
v221 = { initial = 0, shared = true }
v222 = { initial = 0, shared = true }
v223 = { initial = 0, shared = true }
v224 = { initial = 0, shared = true }
v225 = { initial = 0, shared = true }
v226 = { initial = 0, shared = true }
v227 = { initial = 0, shared = true }
v228 = { initial = 0, shared = true }
v229 = { initial = 0, shared = true }
v230 = { initial = 0, shared = true }
v231 = { initial = 0, shared = true }
v232 = { initial = 0, shared = true }
v233 = { initial = 0, shared = true }
v234 = { initial = 0, shared = true }
v235 = { initial = 0, shared = true }
v236 = { initial = 0, shared = true }
v237 = { initial = 0, shared = true }
v238 = { initial = 0, shared = true }
v239 = { initial = 0, shared = true }
v240 = { initial = 0, shared = true }
v241 = { initial = 0, shared = true }
v242 = { initial = 0, shared = true }
v243 = { initial = 0, shared = true }
v244 = { initial = 0, shared = true }
v245 = { initial = 0, shared = true }
v246 = { initial = 0, shared = true }
v247 = { initial = 0, shared = true }
v248 = { initial = 0, shared = true }
v249 = { initial = 0, shared = true }
v250 = { initial = 0, shared = true }
v251 = { initial = 0, shared = true }
v252 = { initial = 0, shared = true }
v253 = { initial = 0, shared = true }
v254 = { initial = 0, shared = true }
v255 = { initial = 0, shared = true }
v256 = { initial = 0, shared = true }
"#,
        &[r#"2:1: variables has 257 shared ones, expected at most 256"#],
    ),
];

#[test]
fn safety_is_not_optional() {
    assert_broken(SAFETY);
}
