#![allow(missing_docs, clippy::all, clippy::print_stdout, clippy::unwrap_used, reason = "scratch")]
use prt_gpu::*;
use sh_core::Order;
use std::time::Instant;

fn obj(path: &str) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let text = std::fs::read_to_string(path).unwrap();
    let (mut p, mut t) = (vec![], vec![]);
    for line in text.lines() {
        let mut w = line.split_whitespace();
        match w.next() {
            Some("v") => { let v: Vec<f32> = w.take(3).map(|x| x.parse().unwrap()).collect(); p.push([v[0], v[1], v[2]]); }
            Some("f") => {
                let v: Vec<u32> = w.map(|x| x.split('/').next().unwrap().parse::<u32>().unwrap() - 1).collect();
                for k in 1..v.len() - 1 { t.push([v[0], v[k], v[k + 1]]); }
            }
            _ => {}
        }
    }
    (p, t)
}
fn normals(p: &[[f32; 3]], t: &[[u32; 3]]) -> Vec<[f32; 3]> {
    let mut n = vec![[0f32; 3]; p.len()];
    for c in t {
        let [a, b, d] = c.map(|v| p[v as usize]);
        let u = [b[0]-a[0], b[1]-a[1], b[2]-a[2]]; let v = [d[0]-a[0], d[1]-a[1], d[2]-a[2]];
        let x = [u[1]*v[2]-u[2]*v[1], u[2]*v[0]-u[0]*v[2], u[0]*v[1]-u[1]*v[0]];
        for k in c { for i in 0..3 { n[*k as usize][i] += x[i]; } }
    }
    for n in &mut n { let l = (n[0]*n[0]+n[1]*n[1]+n[2]*n[2]).sqrt().max(1e-30); for x in n.iter_mut() { *x /= l; } }
    n
}
fn mul(a: [[f32;4];4], b: [[f32;4];4]) -> [[f32;4];4] {
    std::array::from_fn(|c| std::array::from_fn(|r| (0..4).map(|k| a[k][r]*b[c][k]).sum()))
}
fn sub(a:[f32;3],b:[f32;3])->[f32;3]{[a[0]-b[0],a[1]-b[1],a[2]-b[2]]}
fn dot3(a:[f32;3],b:[f32;3])->f32{a[0]*b[0]+a[1]*b[1]+a[2]*b[2]}
fn cross(a:[f32;3],b:[f32;3])->[f32;3]{[a[1]*b[2]-a[2]*b[1],a[2]*b[0]-a[0]*b[2],a[0]*b[1]-a[1]*b[0]]}
fn unit(a:[f32;3])->[f32;3]{let l=dot3(a,a).sqrt();a.map(|x|x/l)}
fn look(eye:[f32;3],target:[f32;3],fov:f32,aspect:f32,near:f32,far:f32)->[[f32;4];4]{
    let z=unit(sub(eye,target)); let x=unit(cross([0.,1.,0.],z)); let y=cross(z,x);
    let v=[[x[0],y[0],z[0],0.],[x[1],y[1],z[1],0.],[x[2],y[2],z[2],0.],[-dot3(x,eye),-dot3(y,eye),-dot3(z,eye),1.]];
    let f=1./(fov*0.5).tan();
    let p=[[f/aspect,0.,0.,0.],[0.,f,0.,0.],[0.,0.,far/(near-far),-1.],[0.,0.,near*far/(near-far),0.]];
    mul(p,v)
}
fn png(path:&str,f:&Frame){
    let mut out=format!("P6\n{} {}\n255\n",f.width,f.height).into_bytes();
    for p in f.composite(|_,_|[0.1,0.1,0.2]) { out.extend(tone_map(p,0.0).map(|x|(x*255.0+0.5) as u8)); }
    std::fs::write(path,out).unwrap();
}
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let (p, t) = obj(&args[1]);
    let size: u32 = args[2].parse().unwrap(); let samples: u32 = args[3].parse().unwrap();
    let close: f32 = args.get(4).map_or(1.0, |x| x.parse().unwrap());
    let n = normals(&p, &t);
    println!("{} vertices {} triangles", p.len(), t.len());
    let order = Order::new(6).unwrap();
    let mut transfer = vec![0f32; 36*p.len()];
    for (row, n) in transfer.chunks_mut(36).zip(&n) { sh_core::eval(order, *n, row); for (l, r) in order.bands() { let k=[3.14159,2.0944,0.785398,0.0,-0.1309,0.0][l]/3.14159; for x in &mut row[r] {*x*=k;} } }
    let albedo: Vec<[f32;3]> = (0..p.len()).map(|i| [0.5+0.4*((i*7%13) as f32/13.0),0.6,0.7]).collect();
    let surface = Surface::new(&p,&t,&albedo,order,1,&transfer).unwrap();
    let mut light = vec![0f32;108];
    let mut y=[0f32;36];
    sh_core::eval(order, unit([0.5,0.8,0.6]), &mut y);
    for c in 0..3 { for i in 0..36 { light[c*36+i] = y[i]*[2.0,1.8,1.5][c]; } light[c*36]+=2.0; }
    let (lo,hi)=p.iter().fold(([f32::MAX;3],[f32::MIN;3]),|(l,h),p|(std::array::from_fn(|i|l[i].min(p[i])),std::array::from_fn(|i|h[i].max(p[i]))));
    let mid:[f32;3]=std::array::from_fn(|i|(lo[i]+hi[i])/2.); let r=dot3(sub(hi,lo),sub(hi,lo)).sqrt()/2.;
    let eye:[f32;3]=std::array::from_fn(|i|mid[i]+[0.3,0.4,2.4][i]*r*close);
    let view=View::new(look(eye,mid,0.8,1.0,r*0.05*close,r*10.),size,size,samples).unwrap();
    let s=Instant::now(); let cpu=cpu::render(&surface,&light,order,&view).unwrap(); println!("cpu {:?}",s.elapsed());
    for _ in 0..3 { let s=Instant::now(); let f=cpu::render(&surface,&light,order,&view).unwrap(); println!("cpu {:?}",s.elapsed()); assert_eq!(f,cpu);}
    png("/tmp/t/cpu.ppm",&cpu);
    let s=Instant::now(); let gpu=Gpu::headless().unwrap(); println!("{}\n open {:?}",gpu.description(),s.elapsed());
    let s=Instant::now(); let mut ren=SurfaceRenderer::new(&gpu,&surface).unwrap(); println!("new {:?}",s.elapsed());
    ren.set_light(&light,order).unwrap();
    let s=Instant::now(); let g=ren.render(&view).unwrap(); println!("gpu first {:?}",s.elapsed());
    for _ in 0..3 { let s=Instant::now(); let _=ren.render(&view).unwrap(); println!("gpu same {:?}",s.elapsed());}
    for k in 0..3 { let mut v=view; v.clip_from_world[3][3]+=1e-5*(k as f32+1.); let s=Instant::now(); let _=ren.render(&v).unwrap(); println!("gpu moved {:?}",s.elapsed());}
    png("/tmp/t/gpu.ppm",&g);
    let ticks=||{let s=std::fs::read_to_string("/proc/self/stat").unwrap(); let f:Vec<&str>=s.rsplit(')').next().unwrap().split_whitespace().collect(); f[11].parse::<u64>().unwrap()+f[12].parse::<u64>().unwrap()};
    { let mut v=view; v.clip_from_world[3][0]+=1e5; let t=Target::new(&gpu,size,size,samples).unwrap();
      for (name,v) in [("empty",v),("full",view),("empty",v),("full",view)] { let s=ticks(); for _ in 0..10 { let mut e=gpu.device().create_command_encoder(&Default::default()); ren.draw(&mut e,&v,&t).unwrap(); gpu.queue().submit([e.finish()]); gpu.device().poll(wgpu::PollType::wait_indefinitely()).unwrap(); } println!("{name} draw cpu ms {}",(ticks()-s)); }
      let s=ticks(); for _ in 0..10 { let _=t.read(&gpu).unwrap(); } println!("read cpu ms {}",(ticks()-s));
      let s=ticks(); for _ in 0..10 { let _=cpu::render(&surface,&light,order,&view).unwrap(); } println!("cpu render cpu ms {}",(ticks()-s));
    }
    let covered:Vec<_>=cpu.pixels.iter().filter(|p|p[3]>0.).collect();
    let mean=covered.iter().map(|p|(p[0]+p[1]+p[2])/3.).sum::<f32>()/covered.len() as f32;
    let mut max=0f32; let mut cov=0; let mut big=0; let mut dep=0;
    for (a,b) in cpu.pixels.iter().zip(&g.pixels){ let d=(0..3).map(|i|(a[i]-b[i]).abs()).fold(0.,f32::max); max=max.max(d); if d>1e-4*mean {big+=1;} if a[3]!=b[3]{cov+=1;}}
    for (a,b) in cpu.depth.iter().zip(&g.depth){ if a!=b {dep+=1;}}
    println!("covered {} mean {mean} max diff {:e} ({:e} of mean), over 1e-4: {big}, coverage differs {cov}, depth differs {dep}",covered.len(),max,max/mean);
}
