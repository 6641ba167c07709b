//! A linked program: its sections, its functions and constants, and the bytes at an address.
//!
//! | module | has |
//! | --- | --- |
//! | `thumb` | what an instruction does to the flow of control and to the stack pointer |
//! | `body` | a function: its calls, the constants it makes, its stack |
//! | `graph` | the whole program: what reaches what, and by how much stack |

use object::elf::{PT_LOAD, SHF_WRITE, STT_FUNC, STT_OBJECT};
use object::read::elf::{ElfFile32, ProgramHeader as _};
use object::{
    Endianness, Object as _, ObjectSection as _, ObjectSymbol as _, SectionFlags, SymbolFlags,
};

/// A function or a constant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// Its path without the hash, or the symbol as it is where it has no path.
    pub name: String,
    /// Where it begins; of a function without the bit that says Thumb.
    pub address: u32,
    /// Bytes, a function's literals included.
    pub size: u32,
}

impl Symbol {
    /// Whether it holds the byte at an address.
    pub fn holds(&self, address: u32) -> bool {
        address.wrapping_sub(self.address) < self.size
    }
}

/// A section that is in memory when the program runs.
#[derive(Clone, Debug)]
pub(super) struct Section {
    pub(super) name: String,
    pub(super) address: u32,
    pub(super) size: u32,
    /// What it is loaded with; empty if it is zeroed or left alone.
    pub(super) bytes: Vec<u8>,
    pub(super) writable: bool,
}

/// A linked program.
#[derive(Clone, Debug)]
pub struct Image {
    pub(super) sections: Vec<Section>,
    pub(super) flash: u32,
    pub(super) functions: Vec<Symbol>,
    pub(super) constants: Vec<Symbol>,
    /// Where code (true) and data (false) begin, by address.
    pub(super) turns: Vec<(u32, bool)>,
}

impl Image {
    /// Reads an ELF.
    ///
    /// # Panics
    /// If that is no 32-bit ELF as our linker makes it.
    pub fn read(elf: &[u8]) -> Self {
        let file = ElfFile32::<Endianness>::parse(elf).expect("a 32-bit ELF");
        let endian = file.endian();
        let loads = file.elf_program_headers().iter().filter(|it| it.p_type(endian) == PT_LOAD);
        let flash = loads.map(|it| it.p_filesz(endian)).sum();
        let mut image = Self {
            sections: file.sections().filter_map(|it| section(&it)).collect(),
            flash,
            functions: Vec::new(),
            constants: Vec::new(),
            turns: Vec::new(),
        };
        for symbol in file.symbols().filter(|it| !it.is_undefined()) {
            let SymbolFlags::Elf { st_info, .. } = symbol.flags() else { continue };
            let (name, address) = (symbol.name().unwrap_or(""), symbol.address() as u32);
            let name_and_place = |address| Symbol {
                name: format!("{:#}", rustc_demangle::demangle(name)),
                address,
                size: symbol.size() as u32,
            };
            match (st_info & 0xf, name) {
                (STT_FUNC, _) => image.functions.push(name_and_place(address & !1)),
                (STT_OBJECT, _) => image.constants.push(name_and_place(address)),
                (_, "$t") => image.turns.push((address, true)),
                (_, "$d") => image.turns.push((address, false)),
                _ => {}
            }
        }
        image.settle();
        image
    }

    /// Sorts by address, names each place once, and gives assembly its size.
    fn settle(&mut self) {
        for symbols in [&mut self.functions, &mut self.constants] {
            // Of the names of one place the one with a size, as aliases may have none.
            symbols.sort_by(|a, b| (a.address, b.size, &a.name).cmp(&(b.address, a.size, &b.name)));
            symbols.dedup_by_key(|it| it.address);
        }
        self.turns.sort_unstable();
        self.turns.dedup_by_key(|(address, _)| *address);
        let ends: Vec<u32> = self.functions.iter().skip(1).map(|it| it.address).collect();
        for (function, next) in self.functions.iter_mut().zip(ends) {
            if function.size == 0 {
                function.size = next - function.address;
            }
        }
    }

    /// Bytes of flash: all that is loaded.
    pub fn flash(&self) -> u32 {
        self.flash
    }

    /// Bytes of RAM that are not stack. A runtime may have a section for the stack, which is all the RAM that is left.
    pub fn statics(&self) -> u32 {
        self.sections.iter().filter(|it| it.writable && it.name != ".stack").map(|it| it.size).sum()
    }

    /// Functions by address.
    pub fn functions(&self) -> &[Symbol] {
        &self.functions
    }

    /// The constant in flash that an address points into.
    pub fn constant(&self, address: u32) -> Option<&Symbol> {
        let constant = last_before(&self.constants, address).filter(|it| it.holds(address))?;
        let rodata =
            |it: &Section| it.name == ".rodata" && address.wrapping_sub(it.address) < it.size;
        self.sections.iter().any(rodata).then_some(constant)
    }

    /// The function that an address points into.
    pub fn function(&self, address: u32) -> Option<&Symbol> {
        last_before(&self.functions, address).filter(|it| it.holds(address))
    }

    /// What the vectors behind the stack pointer point to, reset first, each once.
    pub fn handlers(&self) -> Vec<u32> {
        let Some(vectors) = self.sections.iter().find(|it| it.name == ".vector_table") else {
            return Vec::new();
        };
        let mut handlers = Vec::new();
        for at in (4..vectors.size).step_by(4) {
            match self.word(vectors.address + at) {
                Some(address) if address != 0 && !handlers.contains(&(address & !1)) => {
                    handlers.push(address & !1);
                }
                _ => {}
            }
        }
        handlers
    }

    pub(super) fn bytes<const N: usize>(&self, address: u32) -> Option<[u8; N]> {
        self.sections.iter().find_map(|section| {
            let at = address.checked_sub(section.address)? as usize;
            section.bytes.get(at..at + N)?.try_into().ok()
        })
    }

    pub(super) fn halfword(&self, address: u32) -> Option<u16> {
        self.bytes(address).map(u16::from_le_bytes)
    }

    pub(super) fn word(&self, address: u32) -> Option<u32> {
        self.bytes(address).map(u32::from_le_bytes)
    }

    /// Whether a word of what is loaded beside code has this value.
    pub(super) fn mentions(&self, value: u32) -> bool {
        let data = self.sections.iter().filter(|it| it.name != ".text");
        data.flat_map(|it| it.bytes.chunks_exact(4)).any(|word| word == value.to_le_bytes())
    }

    /// Whether there is code at an address.
    pub(super) fn is_code(&self, address: u32) -> bool {
        let turn = self.turns.partition_point(|(at, _)| *at <= address);
        turn.checked_sub(1).is_some_and(|turn| self.turns[turn].1)
    }
}

fn last_before(symbols: &[Symbol], address: u32) -> Option<&Symbol> {
    let next = symbols.partition_point(|it| it.address <= address);
    symbols.get(next.checked_sub(1)?)
}

fn section(section: &object::read::elf::ElfSection32<'_, '_, Endianness>) -> Option<Section> {
    let SectionFlags::Elf { sh_flags } = section.flags() else { return None };
    if sh_flags & u64::from(object::elf::SHF_ALLOC) == 0 {
        return None;
    }
    Some(Section {
        name: section.name().ok()?.to_owned(),
        address: section.address() as u32,
        size: section.size() as u32,
        bytes: section.data().ok()?.to_vec(),
        writable: sh_flags & u64::from(SHF_WRITE) != 0,
    })
}
