//! The output parameters of an EXO2 sonde, by code.
//!
//! Source: the list of parameter codes in the manuals of YSI's EXO sondes and their signal output
//! adapters.

/// Name and unit of a parameter, if its code is known.
pub fn parameter(code: u16) -> Option<(&'static str, &'static str)> {
    let at = PARAMETERS
        .binary_search_by_key(&code, |(code, ..)| *code)
        .ok()?;
    let (_, name, unit) = PARAMETERS[at];
    Some((name, unit))
}

/// Code, name, unit; in the order of codes.
const PARAMETERS: [(u16, &str, &str); 65] = [
    (1, "temperature", "C"),
    (2, "temperature", "F"),
    (3, "temperature", "K"),
    (4, "conductivity", "mS/cm"),
    (5, "conductivity", "uS/cm"),
    (6, "specific conductance", "mS/cm"),
    (7, "specific conductance", "uS/cm"),
    (10, "TDS", "g/L"),
    (12, "salinity", "PPT"),
    (17, "pH", "mV"),
    (18, "pH", ""),
    (19, "ORP", "mV"),
    (20, "pressure", "psia"),
    (21, "pressure", "psig"),
    (22, "depth", "m"),
    (23, "depth", "ft"),
    (28, "battery", "V"),
    (37, "turbidity", "NTU"),
    (47, "ammonia NH3", "mg/L"),
    (48, "ammonium", "mg/L"),
    (51, "date", "DDMMYY"),
    (52, "date", "MMDDYY"),
    (53, "date", "YYMMDD"),
    (54, "time", "HHMMSS"),
    (95, "TDS", "kg/L"),
    (101, "nitrate", "mV"),
    (106, "nitrate", "mg/L"),
    (108, "ammonium", "mV"),
    (110, "TDS", "mg/L"),
    (112, "chloride", "mg/L"),
    (145, "chloride", "mV"),
    (190, "TSS", "mg/L"),
    (191, "TSS", "g/L"),
    (193, "chlorophyll", "ug/L"),
    (194, "chlorophyll", "RFU"),
    (201, "PAR channel 1", ""),
    (202, "PAR channel 2", ""),
    (204, "rhodamine", "ug/L"),
    (211, "ODO", "% sat"),
    (212, "ODO", "mg/L"),
    (214, "ODO", "% sat local"),
    (215, "TAL-PC", "cells/mL"),
    (216, "BGA-PC", "RFU"),
    (217, "TAL-PE", "cells/mL"),
    (218, "BGA-PE", "RFU"),
    (223, "turbidity", "FNU"),
    (224, "turbidity", "raw"),
    (225, "BGA-PC", "ug/L"),
    (226, "BGA-PE", "ug/L"),
    (227, "fDOM", "RFU"),
    (228, "fDOM", "QSU"),
    (229, "wiper position", "V"),
    (230, "external power", "V"),
    (231, "BGA-PC", "raw"),
    (232, "BGA-PE", "raw"),
    (233, "fDOM", "raw"),
    (234, "chlorophyll", "raw"),
    (235, "potassium", "mV"),
    (236, "potassium", "mg/L"),
    (237, "nLF conductivity", "mS/cm"),
    (238, "nLF conductivity", "uS/cm"),
    (239, "wiper peak current", "mA"),
    (240, "vertical position", "m"),
    (241, "vertical position", "ft"),
    (242, "chlorophyll", "cells/mL"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_in_the_order_of_their_codes() {
        assert!(
            PARAMETERS.is_sorted_by(|a, b| a.0 < b.0),
            "found by a binary search"
        );
    }
}
