#![allow(missing_docs)]
use foxhunt::aoa::*;use foxhunt::random::{SeedableRng,Xoshiro128PlusPlus};use foxhunt_host::{stations::Stations,walker::Walker,reference::{Walkers,mahalanobis},simulate::generator};
fn main(){let a:Vec<String>=std::env::args().collect();let n:u64=a[1].parse().unwrap();let np:usize=a[2].parse().unwrap();let d=std::f64::consts::PI/180.;
 let w=Walker{speed_m_s:1.0,standing_s:5.,walking_s:20.,straight_s:5.};let iv:f64=a[3].parse().unwrap();let s=Stations{readings:(40./iv)as usize,bias_sigma:10.*d,sigma:3.*d,time_s:a[4].parse().unwrap()};
 let mut c=manoeuvring::Config::ROOM;c.speed_m_s=1.0;c.slowest_m_s=1.0;c.stationary_s=5.;c.moving_s=20.;
 if s.time_s<0.01{c.stationary.errors.correlation=robust::Correlation::NONE;} let mut buckets=[(0.,0.);8];let (mut so,mut sr,mut m,mut co,mut cr,mut nof)=(0.,0.,0.,0.,0.,0);
 for run in 0..n{let mut g=generator(5,run);let walk=w.walk(&s,iv,&mut g);let mut r=Walkers::new(w,s,iv,np,&mut g);let mut l=Box::new(Locator::<Manoeuvring<Robust<256>,4>>::new(c).unwrap());let mut rng=Xoshiro128PlusPlus::seed_from_u64(run);
  for (i,round) in walk.sights.chunks(4).enumerate(){for (k,x) in round{let _=l.push(&Observation::try_from(*x).unwrap().from_station(*k),&mut rng);}
   let (mean,cov)=if np>0{r.push(round,&mut g)}else{(nalgebra::Vector2::zeros(),nalgebra::Matrix2::identity())};let t=walk.tag[i];
   if (i as f64)*iv>=5.&&i%((1./iv)as usize)==0{let Some(f)=l.fix() else{nof+=1;continue};m+=1.;let e=[f.position[0]as f64-t[0],f.position[1]as f64-t[1]];so+=e[0]*e[0]+e[1]*e[1];let bk=((i as f64*iv/5.)as usize).min(7);buckets[bk].1+=1.;if f.ellipse(0.95).contains([t[0]as f32,t[1]as f32]){co+=1.;buckets[bk].0+=1.}
    let e=[mean.x-t[0],mean.y-t[1]];sr+=e[0]*e[0]+e[1]*e[1];if mahalanobis(e,&cov)<2.4477{cr+=1.}}}}
 println!("{:?}",buckets.map(|b|(100.*b.0/b.1)as i32));println!("ours {:.3} cov {:.3}  ref {:.3} cov {:.3} nofix {nof}",(so/m).sqrt(),co/m,(sr/m).sqrt(),cr/m);}
