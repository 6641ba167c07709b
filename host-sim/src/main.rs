use host_sim::{field, mission::*, polygon};
use planner_core::estimate::{self, Estimates};
fn main() {
    let n: u64 = std::env::args().nth(1).unwrap().parse().unwrap();
    let steps: u32 = std::env::args().nth(2).unwrap().parse().unwrap();
    let alg = if std::env::args().nth(3).as_deref() == Some("random") { Algorithm::Random } else { Algorithm::Cfc };
    use rayon::prelude::*;
    struct R { bits: Vec<f64>, ang: Vec<[f64;3]>, mis: Vec<f64>, end: String, cost: f64, ex: f64, taken: usize, rec: [u32;4], kinds: std::collections::BTreeMap<String,(f64,u32)> }
    let rs: Vec<R> = (0..n).into_par_iter().map(|i| {
        let m = field::standard(1, i, alg, steps);
        let a0 = estimate::area(&m.space);
        let mut r = R{bits:vec![],ang:vec![],mis:vec![],end:String::new(),cost:0.0,ex:0.0,taken:0,rec:[0;4],kinds:Default::default()};
        let truth=m.truth;
        let end = m.run(|s, space| {
            let e = Estimates::of(space);
            { let last=r.bits.last().copied().unwrap_or(0.0); let b=(a0/estimate::area(space)).log2()-last; let k=format!("{:?} {:?} {}",s.motion.stage,s.motion.recovery, if s.motion.control.v>=2.0 {"full"} else {"part"}); let e=r.kinds.entry(k).or_insert((0.0,0)); e.0+=b; e.1+=1; }
            r.bits.push((a0/estimate::area(space)).log2());
            let f=|l:Option<planner_core::line::Line>| l.map_or(90.0,|l| l.angle_to_deg(&truth));
            r.ang.push([f(e.bisector), f(e.maximum_margin), f(e.centre)]);
            r.mis.push(polygon::misclassified(m.config.area,&truth,&e.centre.unwrap()));
            r.cost += (s.motion.control.v as f64).powi(2)+(s.motion.control.w as f64).powi(2);
            r.ex += s.motion.examined as f64; r.taken+=1;
            r.rec[s.motion.recovery.map_or(0,|x| x as usize+1)]+=1;
        }).unwrap();
        r.end=end.name().into();
        r
    }).collect();
    let med=|mut v:Vec<f64>| {v.sort_by(f64::total_cmp); (v[v.len()/2],v[v.len()*9/10],v[v.len()-1])};
    for t in [5usize,10,20,30,40] { if t as u32>steps {break}
        let at=|r:&R| t.min(r.taken)-1;
        let bits=rs.iter().filter(|r| r.taken>0).map(|r| r.bits[at(r)]/t as f64).sum::<f64>()/rs.len() as f64;
        print!("t={t} bits/step {bits:.5} ");
        for (k,name) in ["bis","mm","cen"].iter().enumerate() { let m=med(rs.iter().filter(|r| r.taken>0).map(|r| r.ang[at(r)][k]).collect()); print!(" {name} {:.3} {:.3} {:.3}",m.0,m.1,m.2); }
        let m=med(rs.iter().filter(|r| r.taken>0).map(|r| r.mis[at(r)]).collect()); println!(" mis {:.5}% {:.5}%",m.0*100.,m.1*100.);
    }
    let tot: usize=rs.iter().map(|r| r.taken).sum();
    println!("cost {:.1} examined/plan {:.1} ({:.2}%)", rs.iter().map(|r| r.cost).sum::<f64>()/n as f64, rs.iter().map(|r| r.ex).sum::<f64>()/tot as f64, rs.iter().map(|r| r.ex).sum::<f64>()/tot as f64/66.57);
    let mut c=std::collections::BTreeMap::new(); for r in &rs {*c.entry(r.end.clone()).or_insert(0)+=1;} println!("{c:?}");
    let mut rec=[0u32;4]; for r in &rs { for k in 0..4 {rec[k]+=r.rec[k];} } println!("none/undirected/reorient/transit {rec:?} of {tot}");

    let mut k=std::collections::BTreeMap::new(); for r in &rs { for (a,b) in &r.kinds { let e=k.entry(a.clone()).or_insert((0.0,0)); e.0+=b.0; e.1+=b.1; } }
    for (a,b) in k { println!("{a:40} {:6} {:.3}", b.1, b.0/b.1 as f64); }
}
